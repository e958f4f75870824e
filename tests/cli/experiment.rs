//! Renders that are ended or killed and go on, and parts of one by many tasks.

use super::{at, burnish, code, err, must, out, run};
#[cfg(unix)]
use super::{signal, until_told};
use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

const SCENE: &str = "screen 48 36\ncamera 0 -6 1 0.5 x 90\nenvironment 0.2 0.3 0.4\n\
                     brdf 0.6 0.5 0.4  0.2 0.2 0.2  20\nmesh tri.obj 0 0 0 1\nsphere 0 0 1  1\n\
                     light 5 4 3\nsphere 2 -1 3  0.5\n";
const MODEL: &str = "v -4 -4 0\nv 4 -4 0\nv 0 4 0\nf 1 2 3\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(at(&folder, "a.scn"), SCENE).unwrap();
    fs::write(at(&folder, "tri.obj"), MODEL).unwrap();
    folder
}

/// Numbers that come again: when a process is killed is not for the clock to say.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 33) % end
    }
}

/// A hundred kills, most of them while a checkpoint is written or a pass is traced: what is there after
/// each is an experiment or nothing, and goes on to the file of a render that nobody killed.
#[cfg(unix)]
#[test]
fn a_hundred_kills_leave_no_trace() {
    const KILLS: usize = 100;
    let folder = folder();
    for (passes, more) in [("300", &[][..]), ("200", &["--uniform"])] {
        let begin = |file: &str, every: &str, threads: &str| {
            let mut command = burnish();
            command.current_dir(folder.path()).args(["render", "-q", "a.scn", "--passes", passes]);
            command.args(["--checkpoint", file, "--every", every, "--threads", threads]).args(more);
            command
        };
        assert!(begin("whole.exr", "60", "2").status().unwrap().success());
        let whole = fs::read(at(&folder, "whole.exr")).unwrap();
        let (mut random, mut kills, mut resumed, mut finished) = (Random(7), 0, 0, 0);
        let file = at(&folder, "killed.exr");
        while kills < KILLS / 2 {
            let threads = ["1", "2", "3"][random.below(3) as usize];
            let mut command = if Path::new(&file).exists() {
                resumed += 1;
                let mut command = burnish();
                command.current_dir(folder.path());
                command.args(["resume", "-q", "killed.exr", "--every", "0", "--threads", threads]);
                command
            } else {
                begin("killed.exr", "0", threads)
            };
            let mut child = command.spawn().unwrap();
            // Most of them once there is a file to go on from, however long the machine takes to it.
            let soon = kills % 8 == 7;
            while !soon && !Path::new(&file).exists() && child.try_wait().unwrap().is_none() {
                sleep(Duration::from_millis(1));
            }
            sleep(Duration::from_micros(random.below(160_000)));
            // Nothing happens to one that has ended.
            child.kill().unwrap();
            let status = child.wait().unwrap();
            if status.success() {
                assert!(fs::read(&file).unwrap() == whole, "after {kills} kills");
                fs::remove_file(&file).unwrap();
                finished += 1;
                continue;
            }
            assert_eq!(status.code(), None, "it failed by itself");
            kills += 1;
            if Path::new(&file).exists() {
                must(&["info", &file]);
            }
        }
        let mut last = match Path::new(&file).exists() {
            true => burnish(),
            false => begin("killed.exr", "60", "2"),
        };
        if Path::new(&file).exists() {
            last.current_dir(folder.path()).args(["resume", "-q", "killed.exr"]);
        }
        assert!(last.status().unwrap().success());
        assert!(fs::read(&file).unwrap() == whole, "after all kills");
        println!("{kills} kills, {resumed} resumed, {finished} ended before theirs");
        assert!(resumed > 10, "{resumed} of {kills} had something to resume");
        fs::remove_file(&file).unwrap();
        fs::remove_file(at(&folder, "whole.exr")).unwrap();
    }
}

#[test]
fn parts_by_many_tasks_are_the_picture_of_one() {
    let folder = folder();
    let inside = |args: &[&str]| burnish().args(args).current_dir(folder.path()).output().unwrap();
    let fine = |args: &[&str]| {
        let output = inside(args);
        assert_eq!(code(&output), 0, "{args:?}: {}", err(&output));
        (out(&output), err(&output))
    };
    let render = ["render", "a.scn", "--passes", "40"];
    fine(&[&render[..], &["--uniform", "--checkpoint", "one.exr", "-o", "one.png"]].concat());
    for number in 1..=7 {
        let (part, file) = (format!("{number}/7"), format!("part-{number}.exr"));
        let more = ["--part", &part, "--checkpoint", &file, "--threads", ["1", "2"][number % 2]];
        let (_, told) = fine(&[&render[..], &more].concat());
        assert!(told.contains("uniform"), "{told}");
    }
    let merge = |numbers: &[usize], file: &str| {
        let parts: Vec<String> = numbers.iter().map(|n| format!("part-{n}.exr")).collect();
        let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
        inside(&[&["merge"], &parts[..], &["-o", file]].concat())
    };
    // One is late.
    let output = merge(&[7, 2, 1, 5, 6, 3], "some.exr");
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(err(&output).contains("lacks passes 16 to 19"), "{}", err(&output));
    let output = inside(&["resume", "some.exr"]);
    assert!(code(&output) == 1 && err(&output).contains("lacks passes 16 to 19"));
    assert!(fine(&["verify", "some.exr"]).0.contains("the same: 36 passes"));
    // What is told to make it again makes it again.
    let told = fine(&["info", "some.exr"]).0;
    assert!(told.contains("it has passes 0 to 15, 20 to 39"), "{told}");
    let command = told.lines().find_map(|line| line.strip_prefix("again")).unwrap().trim();
    let command = command.replace("burnish ", &format!("{} ", env!("CARGO_BIN_EXE_burnish")));
    let shell = std::process::Command::new("sh")
        .args(["-c", &command])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(code(&shell), 0, "{command}: {}", err(&shell));
    let sums = |name: &str| {
        let read = burnish::progressive::Experiment::read(&folder.path().join(name)).unwrap();
        (read.spans().to_vec(), read.picture().0)
    };
    assert!(sums("again.exr") == sums("some.exr"));
    fine(&["merge", "some.exr", "part-4.exr", "-o", "whole.exr"]);
    let bytes = |name: &str| fs::read(at(&folder, name)).unwrap();
    assert!(bytes("whole.exr") == bytes("one.exr"));
    // A merged picture goes on like any other.
    fine(&["resume", "whole.exr", "--passes", "44", "-o", "more.png"]);
    fine(&["resume", "one.exr", "--passes", "44", "--threads", "1"]);
    assert!(bytes("whole.exr") == bytes("one.exr"));
    assert!(fine(&["info", "part-4.exr"]).0.contains("--first-pass 16"));

    // Twice the same, a stranger, no experiment: refused by name, nothing written.
    fine(&[
        "render",
        "a.scn",
        "--passes",
        "8",
        "--uniform",
        "--seed",
        "9",
        "--checkpoint",
        "s.exr",
    ]);
    fine(&["render", "a.scn", "--passes", "8", "-o", "plain.exr"]);
    for (files, words) in [
        (
            &["part-2.exr", "part-3.exr", "some.exr"][..],
            "some.exr, beside part-2.exr: both have passes",
        ),
        (&["part-2.exr", "s.exr"], "s.exr, beside part-2.exr: it has seed 9 and not 0"),
        (&["part-2.exr", "plain.exr"], "plain.exr: is a picture without its sums"),
        (&["part-2.exr", "a.scn"], "a.scn"),
    ] {
        let output = inside(&[&["merge"], files, &["-o", "never.exr"]].concat());
        assert_eq!(code(&output), 1, "{files:?}");
        assert!(err(&output).contains(words), "{}", err(&output));
    }
    assert!(!Path::new(&at(&folder, "never.exr")).exists());
    let output = inside(&["merge", "part-2.exr", "-o", "part-2.exr"]);
    assert!(code(&output) == 1 && err(&output).contains("would be written over"));
}

#[test]
fn what_cannot_go_on_says_why() {
    let folder = folder();
    let inside = |args: &[&str]| burnish().args(args).current_dir(folder.path()).output().unwrap();
    let render = ["render", "a.scn", "--passes", "6", "--checkpoint", "e.exr"];
    assert_eq!(code(&inside(&render)), 0);
    // Nothing is begun anew over what is there.
    let again = inside(&render);
    assert!(code(&again) == 1 && err(&again).contains("burnish resume e.exr"), "{}", err(&again));
    let done = inside(&["resume", "e.exr"]);
    assert!(code(&done) == 0 && err(&done).contains("6 passes already"), "{}", err(&done));
    // One sum off by one: told with its place.
    let changed = {
        use burnish::picture::{Table, read_exr, read_tables, write_with_tables};
        let path = folder.path().join("e.exr");
        let texts = ["burnish", "burnish experiment"];
        let mut read = read_tables(&path, &texts).unwrap();
        let sums = read.tables.iter_mut().find(|table| table.name == "sums").unwrap();
        let of = sums.channels.iter_mut().find(|(name, _)| name == "replicate1.G.0").unwrap();
        of.1[48 * 20 + 11] ^= 1;
        let tables: Vec<_> = read
            .tables
            .iter()
            .map(|t| {
                let fill = |channel: usize, [x, y]: [u32; 2], numbers: &mut [u32]| {
                    let start = (y * t.size[0] + x) as usize;
                    numbers.copy_from_slice(&t.channels[channel].1[start..start + numbers.len()]);
                };
                (t, fill)
            })
            .collect();
        let tables: Vec<Table> = tables
            .iter()
            .map(|(t, fill)| Table {
                name: &t.name,
                size: t.size,
                channels: t.channels.iter().map(|(name, _)| name.clone()).collect(),
                fill,
            })
            .collect();
        let texts: Vec<(&str, &str)> =
            texts.iter().zip(&read.texts).map(|(name, t)| (*name, t.as_deref().unwrap())).collect();
        let to = folder.path().join("changed.exr");
        write_with_tables(&to, &read_exr(&path).unwrap(), &texts, &tables).unwrap();
        "changed.exr"
    };
    let output = inside(&["verify", "e.exr"]);
    assert!(code(&output) == 0 && out(&output).contains("the same: 6 passes of 48x36 pixels"));
    let output = inside(&["verify", changed]);
    assert_eq!((code(&output), out(&output)), (1, String::new()));
    let told = err(&output);
    assert!(
        told.contains("1 of 1728 pixels differ") && told.contains("column 11, row 20"),
        "{told}"
    );
    // A picture without sums is compared by its pixels.
    for args in [
        &["render", "a.scn", "--passes", "20", "--alpha", "0.3", "-o", "p.exr"][..],
        &["render", "cornell", "--size", "20x20", "--passes", "3", "-o", "c.exr"],
    ] {
        assert_eq!(code(&inside(args)), 0);
        let output = inside(&["verify", args[args.len() - 1]]);
        assert!(code(&output) == 0 && out(&output).contains("every mean"), "{}", err(&output));
    }
    // Its scene: elsewhere, changed, gone.
    fs::create_dir(at(&folder, "sub")).unwrap();
    fs::copy(at(&folder, "e.exr"), at(&folder, "sub/e.exr")).unwrap();
    let from_elsewhere = run(&["resume", &at(&folder, "e.exr"), "--passes", "7"]);
    assert_eq!(code(&from_elsewhere), 0, "{}", err(&from_elsewhere));
    let gone = run(&["resume", &at(&folder, "sub/e.exr"), "--passes", "7"]);
    assert!(code(&gone) == 1 && err(&gone).contains("--scene"), "{}", err(&gone));
    let said = ["resume", "sub/e.exr", "--passes", "7", "--scene", "a.scn"];
    assert_eq!(code(&inside(&said)), 0);
    fs::write(at(&folder, "tri.obj"), MODEL.replace("0 4 0", "0 5 0")).unwrap();
    for command in ["resume", "verify"] {
        let output = inside(&[command, "e.exr"]);
        assert!(code(&output) == 1 && err(&output).contains("another tri.obj"), "{}", err(&output));
    }
    let output = inside(&["resume", "no.exr"]);
    assert!(code(&output) == 1 && err(&output).contains("no.exr: cannot be opened"));
    // Arguments that make no sense together.
    for args in [
        &["render", "a.scn", "--checkpoint", "x.png"][..],
        &["render", "a.scn"],
        &["render", "a.scn", "-o", "x.png", "--every", "3"],
        &["render", "a.scn", "--checkpoint", "x.exr", "--part", "0/4"],
        &["render", "a.scn", "--checkpoint", "x.exr", "--part", "5/4"],
        &["render", "a.scn", "--checkpoint", "x.exr", "--part", "1/4", "--time", "3"],
        &["render", "a.scn", "--checkpoint", "x.exr", "--part", "17/17", "--passes", "64"],
        &["render", "a.scn", "--checkpoint", "x.exr", "--first-pass", "6"],
        &["render", "a.scn", "-o", "x.exr", "--checkpoint", "./x.exr"],
        &["merge", "e.exr"],
    ] {
        assert_eq!(code(&inside(args)), 2, "{args:?}: {}", err(&inside(args)));
    }
    assert!(!Path::new(&at(&folder, "x.exr")).exists());
}

/// Ctrl-C keeps what there is, within a pass too, and that goes on.
#[cfg(unix)]
#[test]
fn a_render_ended_by_a_signal_goes_on() {
    let folder = folder();
    let mut command = burnish();
    command.args(["render", "-v", "a.scn", "--size", "300x200", "--passes", "100000000"]);
    command.args(["--checkpoint", "e.exr", "--every", "0"]).current_dir(folder.path());
    let (mut child, lines) = until_told(command, "checkpoint:");
    signal(&child, "-TERM");
    lines.for_each(drop);
    assert!(child.wait().unwrap().success());
    let read =
        |name: &str| burnish::progressive::Experiment::read(&folder.path().join(name)).unwrap();
    let (has, most) = (read("e.exr").passes(), read("e.exr").most_passes());
    // Where it was ended some parts may be further than others, which is not undone.
    for passes in has + 1..most {
        let resume = ["resume", "-q", "e.exr", "--passes", &passes.to_string()];
        let refused = burnish().args(resume).current_dir(folder.path()).output().unwrap();
        assert!(!refused.status.success() && err(&refused).contains(&format!("{most} or more")));
    }
    let end = most.max(has + 3);
    let passes = end.to_string();
    for args in [
        &["resume", "-q", "e.exr", "--passes", &passes][..],
        &[
            "render",
            "-q",
            "a.scn",
            "--size",
            "300x200",
            "--passes",
            &passes,
            "--checkpoint",
            "w.exr",
        ],
    ] {
        assert!(burnish().args(args).current_dir(folder.path()).status().unwrap().success());
    }
    let (resumed, whole) = (read("e.exr"), read("w.exr"));
    assert_eq!((resumed.difference(&whole), resumed.passes()), (None, end));
}
