//! The page of hard cases against the sources: it may not name what does not exist.

use std::fs;
use std::path::Path;

const PAGE: &str = include_str!("../hard_cases.md");

/// The groups with the number of cases in each.
const GROUPS: [(char, usize); 6] =
    [('A', 11), ('B', 19), ('C', 16), ('D', 9), ('E', 34), ('F', 20)];

/// A row of the page's tables: the case and what stands in its last cell.
struct Row<'a> {
    case: &'a str,
    shown_by: &'a str,
}

fn rows(page: &str) -> Vec<Row<'_>> {
    let is_case = |s: &str| {
        let digits = s.trim_start_matches(|c: char| c.is_ascii_uppercase());
        s.len() == digits.len() + 1 && digits.parse::<usize>().is_ok()
    };
    page.lines()
        .filter_map(|line| {
            let cells: Vec<&str> =
                line.trim().trim_matches('|').split('|').map(str::trim).collect();
            let case = *cells.first()?;
            is_case(case).then(|| {
                assert_eq!(cells.len(), 4, "{case}: a row has four cells");
                assert!(cells.iter().all(|cell| !cell.is_empty()), "{case}: an empty cell");
                Row { case, shown_by: cells[3] }
            })
        })
        .collect()
}

/// The file and the function of every test that a cell names.
fn names(cell: &str) -> Vec<(&str, &str)> {
    cell.split('`').skip(1).step_by(2).filter_map(|code| code.split_once("::")).collect()
}

/// Whether a source has a test of this name: a function with `#[test]` among the attributes right
/// above it.
fn has_test(source: &str, name: &str) -> bool {
    let lines: Vec<&str> = source.lines().map(str::trim).collect();
    let head = format!("fn {name}(");
    lines.iter().enumerate().any(|(i, line)| {
        line.starts_with(&head)
            && lines[..i].iter().rev().take_while(|l| l.starts_with("#[")).any(|l| *l == "#[test]")
    })
}

#[test]
fn every_test_that_the_page_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut named = 0;
    for Row { case, shown_by } in rows(PAGE) {
        for (file, name) in names(shown_by) {
            let source = fs::read_to_string(root.join(file))
                .unwrap_or_else(|e| panic!("{case}: cannot read {file}: {e}"));
            assert!(has_test(&source, name), "{case}: {file} has no test {name}");
            named += 1;
        }
    }
    assert!(named > 100, "only {named} tests named: has the page's form changed?");
}

#[test]
fn every_case_has_a_test_or_a_reason() {
    let rows = rows(PAGE);
    let expected: Vec<String> =
        GROUPS.iter().flat_map(|&(group, n)| (1..=n).map(move |i| format!("{group}{i}"))).collect();
    let found: Vec<&str> = rows.iter().map(|r| r.case).collect();
    assert_eq!(found, expected);
    for Row { case, shown_by } in rows {
        let reason = shown_by.strip_prefix("No test: ").is_some_and(|why| why.len() > 30);
        assert!(reason || !names(shown_by).is_empty(), "{case}: neither a test nor a reason");
    }
}

/// The reader of the page, on what it must not take for a test.
#[test]
fn what_is_no_test_is_not_taken_for_one() {
    let source =
        "#[test]\nfn a() {}\n\nfn b() {}\n#[cfg(unix)]\n#[test]\nfn c() {}\n#[test]\nfn ab() {}\n";
    let found = ["a", "b", "c", "ab", "d"].map(|name| has_test(source, name));
    assert_eq!(found, [true, false, true, true, false]);
    let page = "text | A1 |\n| A1 | x | y | `tests/q.rs::t`, `a_p` and `u/v.rs::w` |\n| --- | --- | - | - |\n";
    let rows = rows(page);
    assert_eq!((rows.len(), rows[0].case), (1, "A1"));
    assert_eq!(names(rows[0].shown_by), [("tests/q.rs", "t"), ("u/v.rs", "w")]);
}
