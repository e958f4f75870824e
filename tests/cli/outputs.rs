//! What is written where: never over what is read, nothing twice, and nothing in vain.

use super::{at, burnish, code, err, must, run};
#[cfg(unix)]
use super::{signal, until_told};
use std::fs;
use std::path::Path;

const SCENE: &str = "screen 8 6\nenvironment 1 1 1\nmesh tri.obj 0 0 0 1\n";
const MODEL: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder with a scene, its model and two pictures.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(at(&folder, "a.scn"), SCENE).unwrap();
    fs::write(at(&folder, "tri.obj"), MODEL).unwrap();
    for name in ["a.exr", "b.exr"] {
        must(&["render", "-q", &at(&folder, "a.scn"), "-o", &at(&folder, name), "--passes", "2"]);
    }
    folder
}

/// Everything in a folder, to see what a command has touched.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let name =
        |e: fs::DirEntry| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap());
    let mut all: Vec<_> = fs::read_dir(folder).unwrap().map(|e| name(e.unwrap())).collect();
    all.sort();
    all
}

/// Each is refused before anything is done, whatever the path looks like; no file is touched.
#[test]
fn no_command_writes_over_what_it_reads_or_twice_over_one_file() {
    let folder = folder();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(at(&folder, "a.exr"), at(&folder, "link.exr")).unwrap();
        fs::hard_link(at(&folder, "a.exr"), at(&folder, "hard.exr")).unwrap();
        std::os::unix::fs::symlink(at(&folder, "tri.obj"), at(&folder, "link.json")).unwrap();
    }
    let before = contents(folder.path());
    let cases: [(i32, &[&str]); 10] = [
        (1, &["render", "a.scn", "-o", "d.png", "--stats", "a.scn"]),
        (1, &["render", "a.scn", "-o", "d.png", "--stats", "tri.obj"]),
        (1, &["render", "a.scn", "-o", "d.png", "--stats", "link.json"]),
        (2, &["render", "a.scn", "-o", "d.png", "-o", "./d.png"]),
        (2, &["render", "a.scn", "-o", "a.exr", "-o", "hard.exr"]),
        (1, &["compare", "a.exr", "b.exr", "-o", "a.exr"]),
        (1, &["compare", "a.exr", "b.exr", "--flip", "link.exr"]),
        (1, &["compare", "hard.exr", "b.exr", "-o", "a.exr"]),
        (2, &["compare", "a.exr", "b.exr", "-o", "d.png", "--flip", "./d.png"]),
        (2, &["report", "speed", "a.scn", "--csv", "x", "--plot", "x"]),
    ];
    for (expected, args) in cases {
        let output = burnish().args(args).current_dir(folder.path()).output().unwrap();
        assert_eq!(code(&output), expected, "{args:?}: {}", err(&output));
        let words = ["would be written over", "written twice"];
        assert!(words.iter().any(|word| err(&output).contains(word)), "{args:?}: {}", err(&output));
        assert_eq!(contents(folder.path()), before, "{args:?}");
    }
    // The picture that a scene's own earlier render left is no input.
    let args = ["render", "-q", "a.scn", "-o", "a.exr", "--passes", "2"];
    let output = burnish().args(args).current_dir(folder.path()).output().unwrap();
    assert_eq!(code(&output), 0, "{}", err(&output));
}

/// A limit on the size of files stands in for a disk that fills up while the picture is rendered.
#[cfg(unix)]
#[test]
fn what_can_be_written_is_and_the_rest_is_kept_elsewhere() {
    let folder = folder();
    let spare = tempfile::tempdir().unwrap();
    let gone = folder.path().join("gone");
    fs::create_dir(&gone).unwrap();
    // The folder of one output vanishes while the other's is there.
    let mut command = burnish();
    command
        .args(["render", "-v", "a.scn", "-o", "gone/x.exr", "-o", "kept.png", "--stats", "s.json"])
        .args(["--passes", "1000000000", "--checkpoint", "c.exr", "--every", "0"])
        .env("TMPDIR", spare.path())
        .current_dir(folder.path());
    let (mut child, lines) = until_told(command, "checkpoint:");
    fs::rename(&gone, at(&folder, "away")).unwrap();
    signal(&child, "-INT");
    let told = lines.map(|line| line.unwrap()).collect::<Vec<_>>().join("\n");
    assert_eq!(child.wait().unwrap().code(), Some(1), "{told}");
    assert!(told.contains("gone/x.exr"), "{told}");
    assert!(Path::new(&at(&folder, "kept.png")).exists(), "{told}");
    assert!(Path::new(&at(&folder, "s.json")).exists(), "{told}");
    let rescued = contents(spare.path());
    let [(name, _)] = rescued.as_slice() else { panic!("{told}: {:?}", rescued.len()) };
    assert!(told.contains(name) && name.ends_with(".exr"), "{told}: {name}");
    let picture = burnish::picture::read_exr(&spare.path().join(name)).unwrap();
    assert_eq!((picture.width, picture.height), (8, 6));
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_refused_and_stays() {
    let folder = folder();
    std::os::unix::fs::symlink("nowhere/x.png", at(&folder, "l.png")).unwrap();
    let output = run(&["render", &at(&folder, "a.scn"), "-o", &at(&folder, "l.png")]);
    assert_eq!(code(&output), 1);
    assert!(err(&output).contains("symbolic link to nowhere/x.png"), "{}", err(&output));
    assert!(fs::symlink_metadata(at(&folder, "l.png")).unwrap().is_symlink());
    // A link to a file is followed: the file changes, the link stays.
    fs::write(at(&folder, "real.png"), "").unwrap();
    std::os::unix::fs::symlink("real.png", at(&folder, "good.png")).unwrap();
    must(&["render", "-q", &at(&folder, "a.scn"), "-o", &at(&folder, "good.png")]);
    assert!(fs::symlink_metadata(at(&folder, "good.png")).unwrap().is_symlink());
    assert!(fs::read(at(&folder, "real.png")).unwrap().len() > 50);
}

/// What a killed process left goes at the next save; what somebody writes just now stays, and so
/// does what is not ours.
#[cfg(unix)]
#[test]
fn leftovers_of_the_dead_go_and_those_of_the_living_stay() {
    let folder = folder();
    let make = |name: &str| {
        let file = fs::File::create(at(&folder, name)).unwrap();
        let hour = std::time::Duration::from_secs(3600);
        file.set_modified(std::time::SystemTime::now() - hour).unwrap();
        file
    };
    for name in [".burnish-dead.part", ".burnish-x.png", "burnish-1.part"] {
        drop(make(name));
    }
    let living = make(".burnish-living.part");
    living.lock().unwrap();
    // Young ones may not have their lock yet.
    fs::write(at(&folder, ".burnish-young.part"), "").unwrap();
    must(&["render", "-q", &at(&folder, "a.scn"), "-o", &at(&folder, "new.png")]);
    let there = |name: &str| folder.path().join(name).exists();
    assert!(!there(".burnish-dead.part"));
    for name in [".burnish-x.png", "burnish-1.part", ".burnish-living.part", ".burnish-young.part"]
    {
        assert!(there(name), "{name} is gone");
    }
    drop(living);
    must(&["render", "-q", &at(&folder, "a.scn"), "-o", &at(&folder, "new.png")]);
    assert!(!there(".burnish-living.part"));
}

/// As a batch system ends a job, and as a terminal does that is closed.
#[cfg(unix)]
#[test]
fn other_signals_end_a_render_as_ctrl_c_does() {
    for name in ["-TERM", "-HUP"] {
        let folder = folder();
        let [scene, exr, kept] = ["a.scn", "long.exr", "kept.exr"].map(|name| at(&folder, name));
        let mut command = burnish();
        command.args(["render", "-v", &scene, "-o", &exr, "--passes", "1000000000"]).args([
            "--checkpoint",
            &kept,
            "--every",
            "0",
        ]);
        let (mut child, lines) = until_told(command, "checkpoint:");
        signal(&child, name);
        let told: Vec<String> = lines.map(|line| line.unwrap()).collect();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{name}: {told:?}");
        assert_eq!(burnish::picture::read_exr(exr.as_ref()).unwrap().width, 8, "{name}");
    }
}

/// A name that looks like an option becomes a word that no program takes for one; a name that steers
/// a terminal is written out; a picture whose recipe cannot be is refused, whatever is asked of it.
#[test]
fn names_from_files_are_text_and_nothing_more() {
    let folder = folder();
    let inside = |args: &[&str]| burnish().args(args).current_dir(folder.path()).output().unwrap();
    fs::write(at(&folder, "--stats=victim.scn"), SCENE).unwrap();
    let made =
        inside(&["render", "-q", "--passes", "1", "-o", "p.png", "--", "--stats=victim.scn"]);
    assert_eq!(code(&made), 0, "{}", err(&made));
    let told = super::out(&inside(&["info", "p.png"]));
    let again = told.lines().find(|line| line.starts_with("again")).unwrap();
    let command = again.trim_start_matches("again").trim();
    assert!(command.contains(" ./--stats=victim.scn "), "{command}");
    // It does what it says.
    let program = env!("CARGO_BIN_EXE_burnish");
    let command = command.replacen("burnish", program, 1);
    let done = std::process::Command::new("sh")
        .args(["-c", &command])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(code(&done), 0, "{command}: {}", err(&done));
    assert!(Path::new(&at(&folder, "again.png")).exists());

    #[cfg(unix)]
    {
        let name = "x\u{1b}]52;c;aGk=\u{7}\nburnish: faked.scn";
        fs::write(at(&folder, name), "sphere 0 0 0 zero\n").unwrap();
        for args in
            [&["info", name][..], &["render", name, "-o", "q.png"], &["info", "no\u{1b}.png"]]
        {
            let output = inside(args);
            let told = err(&output) + &super::out(&output);
            assert_eq!(code(&output), 1, "{told}");
            assert!(!told.contains(['\u{1b}', '\u{7}']) && told.lines().count() == 1, "{told:?}");
        }
    }

    let recipe = burnish::picture::read_recipe(at(&folder, "p.png").as_ref()).unwrap().unwrap();
    let picture = burnish::picture::Picture::black(8, 6);
    let write = |recipe: &str| {
        let (path, tone) = (at(&folder, "f.png"), burnish::picture::Tone::default());
        burnish::picture::write_with_recipe(path.as_ref(), &picture, tone, recipe).unwrap();
    };
    write(&recipe);
    assert_eq!(code(&inside(&["info", "f.png"])), 0);
    let broken = [
        ("\"model\": \"ggx\"", "\"model\": \"ggx\\u001b[2J\"", "unknown model, `ggx\\u001b[2J`"),
        ("\"strategy\": \"mis\"", "\"strategy\": \"-o\"", "unknown strategy"),
        ("\"normals\": \"visible\"", "\"normals\": \"\"", "choice of normals"),
        ("\"curve\": \"srgb\"", "\"curve\": \"$(x)\"", "tone curve"),
        ("\"exposure\": 0.0", "\"exposure\": 1e9", "an exposure"),
        ("\"passes\": 1", "\"passes\": 4294967297", "4294967297 passes"),
        ("\"passes\": 1", "\"passes\": 5", "paths"),
        ("\"seed\": 0", "\"seed\": -1", "cannot be read"),
        ("\"alpha\": null", "\"alpha\": 0", "alpha"),
        ("\"max_depth\": null", "\"max_depth\": 0", "a depth limit of 0"),
        ("\"camera\": \"camera ", "\"camera\": \"camera nan ", "camera"),
        ("\"group\": ", "\"group\": 7", "groups of"),
        (
            "\"materials\": []",
            "\"materials\": [{\"index\": 0, \"name\": \"m\", \"line\": null, \
          \"kd\": [2, 0, 0], \"ks\": [0, 0, 0], \"exponent\": 1, \"emission\": [0, 0, 0]}]",
            "Kd",
        ),
        ("\"isa\": \"", "\"isa\": \"x", "instruction set"),
        ("8,\n    6", "0,\n    6", "a size of 0x6"),
    ];
    for (from, to, word) in broken {
        // JSON as it is printed has a blank after each colon and a line a number.
        let changed = recipe.replacen(from, to, 1);
        let changed = if word.starts_with("a size") {
            let at = recipe.find("\"size\"").unwrap();
            recipe[..at].to_owned() + &recipe[at..].replacen('8', "0", 1)
        } else {
            changed
        };
        assert_ne!(changed, recipe, "{from} is not in {recipe}");
        write(&changed);
        for option in
            [&["info", "f.png"][..], &["info", "f.png", "--json"], &["info", "f.png", "--scene"]]
        {
            let output = inside(option);
            assert_eq!(code(&output), 1, "{to}: {}", super::out(&output));
            assert!(err(&output).contains(word), "{to}: {}", err(&output));
        }
    }
}
