//! Stands in for the readers until they are merged.
use burnish::scene::{Material, Place, Report, SceneBuilder, Warning};
use glam::DVec3;

pub(super) fn default_scene() -> (SceneBuilder, Report) {
    let mut b = SceneBuilder::new("three balls");
    let floor = b.material(Material::reflecting("floor", [0.5; 3], [0.04; 3], 20.0).unwrap());
    b.cuboid(DVec3::new(-4.0, -4.0, -0.2), DVec3::new(8.0, 8.0, 0.2), floor).unwrap();
    for (i, a) in [20.0, 200.0, 2000.0].into_iter().enumerate() {
        let m = b.material(
            Material::reflecting(format!("ball {i}"), [0.5, 0.1 * i as f64, 0.2], [0.3; 3], a)
                .unwrap(),
        );
        b.sphere(DVec3::new(i as f64 * 1.6 - 1.6, 0.0, 0.7), 0.7, m).unwrap();
    }
    let l = b.material(Material::light("lamp", [12.0; 3]).unwrap());
    b.sphere(DVec3::new(2.0, -2.0, 4.0), 0.5, l).unwrap();
    b.environment = [0.1; 3];
    let mut report = Report::default();
    report.warnings.push(Warning {
        place: Place { file: "three.scn".into(), line: Some(12) },
        text: "camera quaternion was not of unit length (1.002); it is normalised".into(),
    });
    report.notes.push("lit by one sphere".into());
    (b, report)
}
