use super::*;
use burnish::brdf::{Model, Roughness};
use burnish::progressive::{Counts, Figure, State, TileGrid};
use burnish::scene::{Material, Scene, SceneBuilder};

fn point(seconds: f64, error: f64) -> Point {
    let limits = Interval { low: 0.8 * error, high: 1.25 * error };
    Point { seconds, passes: (100.0 * seconds) as u64, error, limits, reliable: true }
}

fn scene() -> Arc<Scene> {
    let mut builder = SceneBuilder::new("ball");
    let matter = Material::reflecting("matter", [0.1; 3], [0.5; 3], 98.0).unwrap();
    let matter = builder.material(matter);
    builder.sphere(glam::DVec3::ZERO, 1.0, matter).unwrap();
    Arc::new(builder.build())
}

fn snapshot(seconds: f64, passes: u64, error: Option<f64>) -> Snapshot {
    let figure =
        |value: f64| Figure { value, interval: Interval { low: 0.8 * value, high: 1.25 * value } };
    let estimate = |e: f64| ErrorEstimate {
        rel_mse: figure(e * e),
        relative: figure(e),
        rmse: figure(e),
        terms: 100.0,
        reliable: passes >= 32,
    };
    Snapshot {
        epoch: 1,
        grid: TileGrid { size: [10, 10] },
        tiles: Vec::new(),
        dirty: Vec::new(),
        passes,
        whole: true,
        counts: Counts::default(),
        error: error.map(estimate),
        seconds,
        group: burnish::trace::ReuseGroup::None,
        state: State::Running,
    }
}

/// Thirty pictures a second for hours, then for years: few points, the first and the newest among
/// them, and none far from where the curve is.
#[test]
fn a_history_is_bounded_and_true_to_its_curve() {
    let mut history = History::default();
    let error = |seconds: f64| 0.3 / seconds.sqrt();
    let mut seconds: f64 = 1e-5;
    for i in 0..400_000 {
        history.add(point(seconds, error(seconds)));
        seconds += if i < 200_000 { 0.033 } else { 0.01 * seconds };
        seconds = seconds.min(1e12);
    }
    assert!(history.points().len() <= History::MOST, "{}", history.points().len());
    assert!(history.points().len() > 150);
    let newest = history.newest().unwrap();
    assert_eq!(newest.error, error(newest.seconds));
    assert!(history.points().windows(2).all(|p| p[0].seconds < p[1].seconds));
    for seconds in [0.1, 1.0, 7.7, 333.0, 6000.0] {
        let found = history.at(seconds).unwrap();
        assert!((found / error(seconds) - 1.0).abs() < 1e-6, "{seconds}: {found}");
    }
    assert_eq!(history.at(1e-9), None);
    assert_eq!(history.at(1e13), None);
    assert_eq!(history.at(newest.seconds), Some(newest.error));
}

#[test]
fn what_has_no_logarithm_is_left_out() {
    let mut history = History::default();
    for (seconds, error) in [(0.0, 0.1), (1.0, 0.0), (1.0, f64::NAN), (f64::INFINITY, 0.1)] {
        history.add(point(seconds, error));
    }
    assert_eq!(history.points(), []);
}

#[test]
fn a_picture_that_starts_anew_has_a_new_curve_and_one_that_comes_back_goes_on() {
    let scene = scene();
    let ggx = Params::new(scene.clone());
    let phong = Params { model: Model::Phong, ..ggx.clone() };
    let mut curves = Curves::default();
    let times = |curves: &Curves, params: &Params| -> Vec<f64> {
        curves.of(params).unwrap().estimated.points().iter().map(|p| p.seconds).collect()
    };
    for (seconds, passes) in [(0.1, 10), (0.5, 50), (1.0, 100)] {
        curves.note(&ggx, &snapshot(seconds, passes, Some(0.1)));
    }
    curves.note(&phong, &snapshot(0.2, 40, Some(0.2)));
    // From the memory, some of which the background added.
    curves.note(&ggx, &snapshot(1.5, 150, Some(0.05)));
    assert_eq!(times(&curves, &ggx), [0.1, 0.5, 1.0, 1.5]);
    assert_eq!(times(&curves, &phong), [0.2]);
    // Before the first error is known it is known that nothing is left of the picture.
    curves.note_truth(&ggx, 1.5, 150, 0.06);
    curves.note(&ggx, &snapshot(0.01, 0, None));
    assert!(times(&curves, &ggx).is_empty());
    assert!(curves.of(&ggx).unwrap().truth.points().is_empty());
    curves.note(&ggx, &snapshot(0.3, 40, Some(0.15)));
    assert_eq!(times(&curves, &ggx), [0.3]);
    assert_eq!(times(&curves, &phong), [0.2], "another picture's stays");
}

#[test]
fn steps_of_a_drag_and_other_scenes_are_forgotten() {
    let first = Params::new(scene());
    let alpha = |a: f64| first.clone().with_roughness(Roughness::from_alpha(a).unwrap());
    let mut curves = Curves::default();
    curves.note(&alpha(0.5), &snapshot(1.0, 100, Some(0.1)));
    for i in 1..200 {
        curves.note(&alpha(0.5 - 0.002 * f64::from(i)), &snapshot(0.03, 6, Some(0.4)));
    }
    assert_eq!(curves.of_view(&first).len(), 2, "the one before the drag, and the last");
    // Few passes, but slow ones that somebody waited for.
    curves.note(&alpha(0.9), &snapshot(3.0, 6, Some(0.4)));
    curves.note(&alpha(0.8), &snapshot(0.1, 1, None));
    assert_eq!(curves.of_view(&first).len(), 2, "not the last of the drag, but the slow one");
    for i in 1..200 {
        curves.note(&alpha(0.002 * f64::from(i)), &snapshot(0.3, 40, Some(0.2)));
    }
    assert_eq!(curves.of_view(&first).len(), Curves::MOST);
    curves.note(&Params::new(scene()), &snapshot(0.1, 8, Some(0.2)));
    assert_eq!(curves.curves.len(), 1, "no other scene is kept in memory by its curves");
}

#[test]
fn curves_of_the_view_are_told_apart_by_name_and_are_in_order() {
    let shown = Params::new(scene());
    let rough = shown.clone().with_roughness(Roughness::from_alpha(0.4).unwrap());
    let mut moved = shown.clone();
    moved.camera.eye.x += 1.0;
    let others = [
        rough,
        Params { model: Model::Phong, ..shown.clone() },
        Params { strategy: burnish::progressive::Strategy::LightOnly, seed: 5, ..shown.clone() },
        moved,
        Params { model: Model::Beckmann, ..shown.clone() },
    ];
    let mut curves = Curves::default();
    for params in [&shown].into_iter().chain(&others) {
        curves.note(params, &snapshot(1.0, 100, Some(0.1)));
    }
    curves.note_truth(&shown, 1.0, 100, 0.125);
    let of_view = curves.of_view(&shown);
    let names: Vec<String> = of_view.iter().map(|c| name(&c.params, &shown)).collect();
    let light = burnish::progressive::Strategy::LightOnly.title();
    let other = format!("GGX 0.141, {light}, seed 5");
    assert_eq!(names, ["GGX 0.141", "Phong 0.141", "Beckmann 0.141", &other, "GGX 0.400"]);
    let table = csv(&of_view, &shown);
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 1 + 5 + 1);
    assert_eq!(
        lines[1],
        "\"GGX 0.141\",estimated,1.000000,100,1.000000e-1,8.000000e-2,1.250000e-1,true"
    );
    assert!(lines[2].starts_with("\"GGX 0.141\",true,1.000000,100,1.250000e-1"), "{table}");
}

#[test]
fn another_reference_has_other_distances() {
    let params = Params::new(scene());
    let mut curves = Curves::default();
    curves.note_truth(&params, 1.0, 100, 0.1);
    assert!(curves.of(&params).is_none(), "a distance alone is of no picture");
    curves.note(&params, &snapshot(2.0, 200, Some(0.1)));
    curves.note_truth(&params, 2.0, 200, 0.11);
    curves.note_truth(&params, 1.0, 100, 0.2);
    let truth = |curves: &Curves| curves.of(&params).unwrap().truth.points().len();
    assert_eq!(truth(&curves), 1, "an answer that comes too late is left out");
    curves.forget_truth();
    assert_eq!(truth(&curves), 0);
}

/// A point of so many passes in a hundredth of the seconds, with this upper limit.
pub(crate) fn point_at(passes: u64, high: f64, reliable: bool) -> Point {
    let limits = Interval { low: 0.6 * high, high };
    Point { seconds: 0.01 * passes as f64, passes, error: 0.8 * high, limits, reliable }
}

/// A history of these points.
pub(crate) fn history(points: impl Iterator<Item = Point>) -> History {
    let mut history = History::default();
    points.for_each(|p| history.add(p));
    history
}
