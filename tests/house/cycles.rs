//! Cycles between the files of a room.
//!
//! File A knows file B if code of A, its tests left out, names an item that is defined at the top level of
//! B: by `use` or by a path; `use other::*` names `other`. Names are followed through re-exports to where they
//! are defined, so that `pub use child::Item` in a parent is no knowledge of the child; nor is `mod child;`. A
//! file and those in the folder of its name, which are its own parts, may know each other: theirs is not
//! counted.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// One file's code in words: names, `::`, and single signs.
fn words(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let (mut words, mut i) = (Vec::new(), 0);
    while i < chars.len() {
        let c = at(i);
        if c == '/' && at(i + 1) == '/' {
            i += chars[i..].iter().take_while(|&&c| c != '\n').count();
        } else if c == '"' {
            i = end_of_text(&chars, i);
        } else if c == '\'' {
            // A character in quotes, or a lifetime.
            let quoted = if at(i + 1) == '\\' {
                Some(i + 2)
            } else {
                Some(i + 1).filter(|_| at(i + 2) == '\'')
            };
            i = match quoted {
                Some(from) => {
                    from + 1
                        + chars[(from + 1).min(chars.len())..]
                            .iter()
                            .take_while(|&&c| c != '\'')
                            .count()
                        + 1
                }
                None => i + 1,
            };
        } else if c.is_alphanumeric() || c == '_' {
            let length =
                chars[i..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
            let word: String = chars[i..i + length].iter().collect();
            i += length;
            if matches!(word.as_str(), "r" | "br")
                && matches!(at(i), '"' | '#')
                && raw_end(&chars, i).is_some()
            {
                i = raw_end(&chars, i).unwrap();
            } else {
                words.push(word);
            }
        } else if c == ':' && at(i + 1) == ':' {
            words.push("::".to_owned());
            i += 2;
        } else {
            if !c.is_whitespace() {
                words.push(c.to_string());
            }
            i += 1;
        }
    }
    words
}

/// The place behind a text in double quotes that begins here.
fn end_of_text(chars: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// The place behind the rest of a raw text, `#"..."#`; none if it is no such.
fn raw_end(chars: &[char], start: usize) -> Option<usize> {
    let marks = chars[start..].iter().take_while(|&&c| c == '#').count();
    if chars.get(start + marks) != Some(&'"') {
        return None;
    }
    let from = start + marks + 1;
    let ends = |i: &usize| {
        chars[*i] == '"'
            && chars[*i + 1..].iter().take_while(|&&c| c == '#').take(marks).count() == marks
    };
    (from..chars.len()).find(ends).map(|i| i + 1 + marks)
}

/// Without what is compiled for tests alone.
fn without_tests(words: Vec<String>) -> Vec<String> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut i) = (Vec::new(), 0);
    while i < words.len() {
        if words[i..].iter().take(mark.len()).eq(mark.iter()) {
            // To the end of the item: a semicolon or comma, or the brace that closes it.
            let (mut depth, mut j) = (0i32, i + mark.len());
            while j < words.len() {
                match words[j].as_str() {
                    "{" | "(" | "[" => depth += 1,
                    "}" if depth == 0 => break,
                    ")" | "]" => depth -= 1,
                    "}" => {
                        depth -= 1;
                        if depth == 0 {
                            j += 1;
                            break;
                        }
                    }
                    ";" | "," if depth == 0 => {
                        j += 1;
                        break;
                    }
                    _ => {}
                }
                j += 1;
            }
            i = j;
        } else {
            kept.push(words[i].clone());
            i += 1;
        }
    }
    kept
}

/// A name as it is written, such as `super`, `sheet`, `Cell`.
type Name = Vec<String>;

/// What a file says of names.
#[derive(Default)]
struct File {
    /// Items at its top level.
    defines: BTreeSet<String>,
    children: BTreeSet<String>,
    /// Names brought in by `use`, with the paths they stand for, and whether they are handed on.
    uses: Vec<(String, Name, bool)>,
    /// Paths of two names or more in its code.
    paths: BTreeSet<Name>,
}

/// A `use` tree from `at`: the names it brings in. Returns the place behind it.
fn tree(words: &[String], mut at: usize, before: &Name, found: &mut Vec<(String, Name)>) -> usize {
    let mut path = before.clone();
    loop {
        match words.get(at).map(String::as_str) {
            Some("{") => {
                at += 1;
                while words.get(at).is_some_and(|w| w != "}") {
                    at = tree(words, at, &path, found);
                    at += usize::from(words.get(at).is_some_and(|w| w == ","));
                }
                return at + 1;
            }
            Some("*") => {
                path.push("*".to_owned());
                found.push(("*".to_owned(), path));
                return at + 1;
            }
            Some("::") => at += 1,
            Some("as") => {
                let alias = words.get(at + 1).cloned().unwrap_or_default();
                found.push((alias, path));
                return at + 2;
            }
            Some(word) if word.starts_with(|c: char| c.is_alphabetic() || c == '_') => {
                let ends = !matches!(words.get(at + 1).map(String::as_str), Some("::" | "as"));
                if word != "self" || path.is_empty() {
                    path.push(word.to_owned());
                }
                at += 1;
                if ends {
                    found.push((path.last().cloned().unwrap_or_default(), path));
                    return at;
                }
            }
            _ => return at,
        }
    }
}

impl File {
    fn read(text: &str) -> File {
        let words = without_tests(words(text));
        let word = |i: usize| words.get(i).map_or("", String::as_str);
        let mut file = File::default();
        let (mut depth, mut i) = (0, 0);
        while i < words.len() {
            match word(i) {
                "{" => depth += 1,
                "}" => depth -= 1,
                "use" if word(i + 1) != "<" => {
                    let handed_on =
                        word(i.wrapping_sub(1)) == "pub" || word(i.wrapping_sub(1)) == ")";
                    let mut found = Vec::new();
                    i = tree(&words, i + 1, &Vec::new(), &mut found);
                    file.uses.extend(found.into_iter().map(|(name, path)| (name, path, handed_on)));
                    continue;
                }
                "mod" if depth == 0 && word(i + 2) == ";" => {
                    file.children.insert(word(i + 1).to_owned());
                }
                "struct" | "enum" | "trait" | "type" | "fn" | "const" | "static" | "union"
                    if depth == 0 =>
                {
                    file.defines.insert(word(i + 1).to_owned());
                }
                "macro_rules" => {
                    file.defines.insert(word(i + 2).to_owned());
                }
                _ => {}
            }
            if word(i + 1) == "::" && word(i.wrapping_sub(1)) != "::" {
                let mut path = vec![word(i).to_owned()];
                let mut j = i;
                while word(j + 1) == "::"
                    && word(j + 2).starts_with(|c: char| c.is_alphabetic() || c == '_')
                {
                    j += 2;
                    path.push(word(j).to_owned());
                }
                if path.len() > 1 {
                    file.paths.insert(path);
                }
            }
            i += 1;
        }
        file
    }
}

/// All files by the path of their module, such as `scene`, `read`, `obj`.
type Files = BTreeMap<Name, File>;

/// The module in whose file a name is defined, as seen from a module; none if that is elsewhere.
fn definer(files: &Files, from: &Name, path: &[String], steps: usize) -> Option<Name> {
    let (mut module, mut rest) = (from.clone(), path);
    match path.first()?.as_str() {
        "crate" => (module, rest) = (Vec::new(), &path[1..]),
        "self" => rest = &path[1..],
        "super" => {
            while rest.first().is_some_and(|s| s == "super") {
                module.pop()?;
                rest = &rest[1..];
            }
        }
        _ => {}
    }
    while let Some(name) = rest.first() {
        let file = files.get(&module)?;
        if file.children.contains(name) {
            module.push(name.clone());
            rest = &rest[1..];
            continue;
        }
        if name == "*" || file.defines.contains(name) {
            return Some(module);
        }
        let steps = steps.checked_sub(1)?;
        let on = |behind: &Name| {
            let whole: Name = behind.iter().chain(&rest[1..]).cloned().collect();
            // A name that stands for itself is a crate's.
            (behind != &vec![name.clone()])
                .then(|| definer(files, &module, &whole, steps))
                .flatten()
        };
        let named = file.uses.iter().find(|(alias, ..)| alias == name);
        if let Some((_, behind, _)) = named {
            return on(behind);
        }
        return file.uses.iter().filter(|(alias, ..)| alias == "*").find_map(|(_, behind, _)| {
            let all = behind.iter().filter(|name| *name != "*");
            let whole: Name = all.chain(rest).cloned().collect();
            definer(files, &module, &whole, steps)
        });
    }
    None
}

/// Which files know which others of their room.
fn knowledge(files: &Files) -> BTreeMap<Name, BTreeSet<Name>> {
    let mut all = BTreeMap::new();
    for (module, file) in files {
        let used = file.uses.iter().filter(|(.., handed_on)| !handed_on).map(|(_, path, _)| path);
        let known = used.chain(&file.paths).filter_map(|path| definer(files, module, path, 8));
        let of_room = |other: &Name| {
            let within = other.starts_with(module) || module.starts_with(other);
            !within && other.first() == module.first()
        };
        all.insert(module.clone(), known.filter(of_room).collect());
    }
    all
}

/// The files that each file leads to, by any number of steps.
fn reach(edges: &BTreeMap<Name, BTreeSet<Name>>, from: &Name) -> BTreeSet<Name> {
    let (mut seen, mut left) = (BTreeSet::new(), vec![from.clone()]);
    while let Some(module) = left.pop() {
        for next in edges.get(&module).into_iter().flatten() {
            if seen.insert(next.clone()) {
                left.push(next.clone());
            }
        }
    }
    seen
}

/// The sets of files of which each leads to all others.
fn cycles(edges: &BTreeMap<Name, BTreeSet<Name>>) -> Vec<BTreeSet<Name>> {
    let reached: BTreeMap<&Name, BTreeSet<Name>> =
        edges.keys().map(|m| (m, reach(edges, m))).collect();
    let mut found: Vec<BTreeSet<Name>> = Vec::new();
    for (module, to) in &reached {
        let back = |other: &&Name| reached.get(*other).is_some_and(|r| r.contains(*module));
        let cycle: BTreeSet<Name> = to.iter().filter(back).cloned().collect();
        if cycle.len() > 1 && !found.contains(&cycle) {
            found.push(cycle);
        }
    }
    found
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("tests") || path.ends_with("tests.rs") {
            continue;
        } else if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

fn files() -> Files {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    sources(&root, &mut paths);
    let mut files = Files::new();
    for path in paths {
        let place = path.strip_prefix(&root).unwrap().with_extension("");
        let mut module: Name = place.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        if module.last().is_some_and(|l| l == "mod") {
            module.pop();
        }
        let file = File::read(&fs::read_to_string(&path).unwrap());
        // The library's root and the program's are one: neither names what the other has.
        if matches!(module.first().map(String::as_str), Some("lib" | "main")) && module.len() == 1 {
            let root = files.entry(Vec::new()).or_default();
            root.children.extend(file.children);
            root.uses.extend(file.uses);
            root.defines.extend(file.defines);
        } else {
            files.insert(module, file);
        }
    }
    files
}

fn written(modules: &BTreeSet<Name>) -> BTreeSet<String> {
    modules.iter().map(|module| module.join("/")).collect()
}

#[test]
fn files_of_a_room_know_each_other_one_way() {
    let files = files();
    let edges = knowledge(&files);
    let arrows: usize = edges.values().map(BTreeSet::len).sum();
    assert!(files.len() > 300 && arrows > 600, "{} files, {arrows} arrows", files.len());
    let found: Vec<BTreeSet<String>> = cycles(&edges).iter().map(written).collect();
    let mut all = String::new();
    for (from, to) in edges.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to))) {
        let ends = [from.join("/"), to.join("/")];
        if found.iter().any(|cycle| ends.iter().all(|end| cycle.contains(end))) {
            all += &format!("{} names what is in {}\n", ends[0], ends[1]);
        }
    }
    assert!(
        found.is_empty(),
        "a cycle, to be opened by moving what both name to a file of its own:\n{all}"
    );
}

/// The cycles among some files, given by the path of their module and their text.
fn among(texts: &[(&str, &str)]) -> Vec<BTreeSet<String>> {
    let name = |path: &str| path.split('/').filter(|p| !p.is_empty()).map(String::from).collect();
    let files: Files = texts.iter().map(|(path, text)| (name(path), File::read(text))).collect();
    cycles(&knowledge(&files)).iter().map(written).collect()
}

const ROOT: (&str, &str) = ("", "mod room;");
const ROOM: (&str, &str) = ("room", "mod a; mod b; pub use a::A; pub use b::{B, make as made};");

#[test]
fn names_are_followed_to_where_they_are_defined() {
    let both = [BTreeSet::from(["room/a".to_owned(), "room/b".to_owned()])];
    for (a, b) in [
        ("use super::B; pub struct A;", "use super::{A, c}; pub struct B; pub fn make() {}"),
        ("pub struct A(super::b::B);", "use crate::room::a::*; pub struct B(A);"),
        ("use super::made; pub enum A { X }", "pub fn make() { let _ = super::A::X; } struct B;"),
        ("use super::b; pub struct A; fn f() { b::make() }", "use super::a::A; pub fn make() {}"),
    ] {
        assert_eq!(among(&[ROOT, ROOM, ("room/a", a), ("room/b", b)]), both, "{a} {b}");
    }
}

#[test]
fn what_is_no_knowledge_makes_no_cycle() {
    let a = "use super::B; pub struct A(B);";
    for b in [
        "pub struct B; pub fn make() {}",
        "pub struct B; // super::A",
        "pub struct B; const TEXT: &str = \"super::A \\\" super::A\";",
        "pub struct B; const TEXT: &str = r#\"super::A \" super::A\"#;",
        "pub struct B; const QUOTE: char = '\"'; // super::A",
        "pub struct B; #[cfg(test)] mod tests { use super::super::A; }",
        "pub struct B; #[cfg(test)] pub(crate) use super::A;",
        "pub use super::A; pub struct B;",
        "pub struct B<'a>(&'a str); use other::A;",
    ] {
        assert_eq!(among(&[ROOT, ROOM, ("room/a", a), ("room/b", b)]), [], "{b}");
    }
    // A parent and its child.
    let room = ("room", "mod a; use a::A; pub struct R(A);");
    assert_eq!(among(&[ROOT, room, ("room/a", "use super::R; pub struct A(R);")]), []);
}
