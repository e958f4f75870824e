//! Renders that stop and go on, and parts that become one: to the bit what they would have been.

use burnish::brdf::{Model, Roughness};
use burnish::progressive::{
    Experiment, ExperimentError, Options, Params, Recipe, Session, State, part, render,
};
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Scene};
use burnish::trace::ReuseGroup;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};

fn cornell() -> Arc<Scene> {
    Arc::new(Example::named("cornell").unwrap().read().unwrap().0.build())
}

fn params(scene: &Arc<Scene>) -> Params {
    Params { size: [70, 50], seed: 3, ..Params::new(scene.clone()) }
}

/// What a session has once it is done.
fn kept(session: &Session) -> Experiment {
    let over = session.snapshots().iter().find(|s| s.state != State::Running).unwrap();
    assert_eq!(over.state, State::Done);
    let (tell, told) = mpsc::channel();
    session.visit_experiment(move |experiment| tell.send(experiment.clone()).unwrap());
    told.recv().unwrap()
}

fn traced(params: &Params, passes: u64, threads: usize) -> Experiment {
    let options = Options::headless(threads);
    kept(&Session::with_options(params.clone(), passes, options, || {}).unwrap())
}

fn on(experiment: Experiment, scene: &Arc<Scene>, passes: u64, threads: usize) -> Experiment {
    let options = Options::headless(threads);
    kept(&Session::with_experiment(experiment, scene.clone(), passes, options, || {}).unwrap())
}

/// Its file's content, and what is read from it.
fn filed(experiment: &Experiment) -> (Vec<u8>, Experiment) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("e.exr");
    experiment.save(&path).unwrap();
    (fs::read(&path).unwrap(), Experiment::read(&path).unwrap())
}

/// Before, at and after each plan; with everything set that a render can have, too.
#[test]
fn a_render_that_stops_anywhere_goes_on_with_the_same_bits() {
    let scene = cornell();
    let all_set = |uniform: bool| {
        let params = params(&scene).with_roughness(Roughness::from_alpha(0.137).unwrap());
        let mut materials = params.materials.to_vec();
        materials[0].kd = [0.1, 0.7, 0.3];
        materials[1].roughness = Roughness::from_exponent(33.3).unwrap();
        Params {
            materials: Arc::new(materials),
            camera: Camera { ry: 0.31, ..params.camera },
            model: Model::Beckmann,
            max_depth: Some(7),
            uniform,
            ..params
        }
    };
    let all = [
        (params(&scene), 70, &[1, 4, 15, 16, 17, 40, 63, 64, 66][..]),
        (Params { uniform: true, ..params(&scene) }, 23, &[1, 2, 16, 17]),
        (all_set(true), 9, &[5]),
        (all_set(false), 22, &[19]),
        (Params { first_pass: 12, uniform: true, ..params(&scene) }, 11, &[6]),
    ];
    for (params, passes, stops) in all {
        let whole = traced(&params, passes, 2);
        let (file, read) = filed(&whole);
        assert!(read == whole);
        let plain = render(params.clone(), passes, 1).unwrap();
        let (picture, error, recipe) = whole.picture();
        assert!(picture == plain.mean() && error == plain.error);
        assert_eq!(recipe, Recipe::new(&params, &plain));
        assert_eq!(read.params(scene.clone()).unwrap(), params);
        for (which, &stop) in stops.iter().enumerate() {
            let (_, first) = filed(&traced(&params, stop, 1 + which % 3));
            let (_, second) = filed(&on(first, &scene, (stop + 2).min(passes), 3 - which % 3));
            let resumed = on(second, &scene, passes, 1 + which % 2);
            assert_eq!(whole.difference(&resumed), None, "stopped after {stop}");
            assert!(filed(&resumed).0 == file, "stopped after {stop}");
        }
    }
}

#[test]
fn parts_in_any_order_are_the_whole() {
    let scene = cornell();
    let params = Params { uniform: true, ..params(&scene) };
    let (passes, of) = (43, 5);
    let mut whole = traced(&params, passes, 2);
    whole.goal.passes = Some(passes);
    whole.goal.end = Some(passes);
    let parts: Vec<Experiment> = (1..=of)
        .map(|number| {
            let own = part(passes, number, of).unwrap();
            let params = Params { first_pass: own.start, ..params.clone() };
            let mut part = traced(&params, own.end - own.start, 1 + number as usize % 2);
            (part.goal.passes, part.goal.end) = (Some(passes), Some(own.end));
            filed(&part).1
        })
        .collect();
    for order in [[0, 1, 2, 3, 4], [4, 1, 3, 0, 2]] {
        let mut merged = parts[order[0]].clone();
        for &number in &order[1..] {
            // By way of a file each time, as in a tree of merges.
            merged = filed(&merged).1;
            merged.merge(&parts[number]).unwrap();
        }
        assert_eq!(merged.spans(), [[0, passes]]);
        assert_eq!(whole.difference(&merged), None);
        assert!(filed(&merged).0 == filed(&whole).0);
        // And it goes on like any other.
        let longer = on(merged, &scene, passes + 3, 2);
        assert_eq!(longer.difference(&traced(&params, passes + 3, 1)), None);
    }
    // Each part knows its own error, and a picture of it has its recipe.
    let (picture, error, recipe) = parts[1].picture();
    assert!(error.is_some() && picture != whole.picture().0);
    assert_eq!((recipe.first_pass, recipe.passes), (8, 8));
}

#[test]
fn what_does_not_fit_is_refused_and_says_why() {
    let scene = cornell();
    let group = Some(ReuseGroup::Sixteen);
    let uniform = Params { uniform: true, size: [20, 10], group, ..params(&scene) };
    let first = traced(&uniform, 8, 1);
    let at =
        |first_pass: u64, passes: u64| traced(&Params { first_pass, ..uniform.clone() }, passes, 1);
    let mut merged = first.clone();
    let error = merged.merge(&at(4, 8)).unwrap_err();
    assert!(matches!(error, ExperimentError::Overlap(4, 7)), "{error}");
    type Change<'a> = (&'static str, &'a dyn Fn(&mut Params));
    let changes: [Change; 8] = [
        ("seed 4 and not 3", &|p| p.seed = 4),
        ("model phong and not ggx", &|p| p.model = Model::Phong),
        ("size 20x11 and not 20x10", &|p| p.size = [20, 11]),
        ("camera ", &|p| p.camera.ry *= 1.5),
        ("depth limit 3 and not none", &|p| p.max_depth = Some(3)),
        ("materials", &|p| Arc::make_mut(&mut p.materials)[0].kd = [0.5; 3]),
        ("tracer reference and not engine", &|p| p.reference = true),
        ("groups of 32 and not 16", &|p| p.group = Some(ReuseGroup::ThirtyTwo)),
    ];
    for (words, change) in changes {
        let mut other = Params { first_pass: 8, ..uniform.clone() };
        change(&mut other);
        let error = merged.merge(&traced(&other, 4, 1)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let planned = traced(&Params { uniform: false, ..uniform.clone() }, 4, 1);
    let error = merged.merge(&planned).unwrap_err().to_string();
    assert!(error.contains("passes that are planned and not uniform"), "{error}");
    let error = planned.clone().merge(&planned).unwrap_err();
    assert!(matches!(error, ExperimentError::Uneven), "{error}");
    assert!(merged == first, "what is refused leaves no trace");

    merged.merge(&at(16, 4)).unwrap();
    assert_eq!((merged.spans(), merged.gap()), (&[[0, 8], [16, 20]][..], Some([8, 16])));
    let options = Options::headless(1);
    let refused = |e: &Experiment, scene: &Arc<Scene>| {
        Session::with_experiment(e.clone(), scene.clone(), 30, options, || {})
    };
    let error = refused(&filed(&merged).1, &scene).unwrap_err();
    assert!(matches!(error, ExperimentError::Gap(8, 15)), "{error}");
    merged.merge(&at(8, 8)).unwrap();
    assert_eq!(merged.difference(&at(0, 20)), None);

    let plates = Arc::new(Example::named("plates").unwrap().read().unwrap().0.build());
    let error = refused(&first, &plates).unwrap_err().to_string();
    assert!(error.contains("it has cornell.scn and not plates.scn"), "{error}");
}

/// A scene whose model has changed since is named with the file that has.
#[test]
fn a_changed_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.scn"), "screen 8 6\nenvironment 1 1 1\nmesh tri.obj 0 0 0 1\n").unwrap();
    fs::write(at("tri.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let read = |path: &Path| Arc::new(burnish::scene::read::open(path).unwrap().0.build());
    let experiment = traced(&Params::new(read(&at("a.scn"))), 4, 1);
    assert!(experiment.params(read(&at("a.scn"))).is_ok());
    fs::write(at("tri.obj"), "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n").unwrap();
    let error = experiment.params(read(&at("a.scn"))).unwrap_err().to_string();
    assert!(error.contains("another tri.obj: SHA-256 "), "{error}");
}

/// Other readers see the picture, and nothing of the sums.
#[test]
fn an_experiment_is_a_picture_too() {
    let scene = cornell();
    let experiment = traced(&params(&scene), 20, 2);
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("e.exr");
    experiment.save(&path).unwrap();
    let read = burnish::picture::read_exr_part(&path, None).unwrap();
    assert!(read.picture == experiment.picture().0);
    assert_eq!((read.choices, read.remarks), (1, Vec::new()));
    let recipe = burnish::picture::read_recipe(&path).unwrap().unwrap();
    assert_eq!(Recipe::parse(&recipe).unwrap(), experiment.picture().2);
    // A picture of today has no sums, and says which has.
    let plain = folder.path().join("p.exr");
    let (picture, _, recipe) = experiment.picture();
    recipe.save(&plain, &picture, Default::default()).unwrap();
    let error = Experiment::read(&plain).unwrap_err().to_string();
    assert!(error.contains("p.exr") && error.contains("--checkpoint"), "{error}");
}
