//! Cases drawn at random: every group by turns, with parameters of no round number, turned, scaled
//! and moved, on every instruction set that the machine has.

use super::emitters::{PlaneDisk, PlaneQuad, PlaneRect, PlaneSphere};
use super::glossy::{Ball, Dome, Finish, Mirror, SpecRect, SpecSphere};
use super::group::Group;
use super::rooms::{Cavity, Concentric, Furnace, Integrating, ParallelPlanes};
use super::stage::Where;
use super::table::{Case, CaseTable};
use super::{ExactError, factors};
use crate::brdf::Model;
use crate::math::simd::Isa;
use crate::measure::draw::Draw;
use crate::measure::site::Somewhere;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Of the numbers that cases are drawn by.
const FAMILY: u64 = 0x6578_6163_7421;
/// Groups of scenes.
const GROUPS: u64 = 14;

/// Cases of these seeds, groups by turns.
pub fn drawn(seeds: impl IntoIterator<Item = u64>) -> Result<CaseTable, ExactError> {
    let cases: Vec<Case> = seeds.into_iter().map(case).collect::<Result<_, _>>()?;
    Ok(CaseTable { scenes: cases.len(), cases, left_out: Vec::new() })
}

/// The case of a seed.
fn case(seed: u64) -> Result<Case, ExactError> {
    let mut draw = Draw::new(FAMILY, seed);
    let isas = Isa::available();
    let isa = isas[((seed / GROUPS + seed) % isas.len() as u64) as usize];
    loop {
        let (group, quantity) = group(seed % GROUPS, &mut draw);
        // A cavity that gains light has no answer.
        let Some(known) = group.known(&quantity)? else { continue };
        let place = Somewhere::draw(&mut draw);
        return Ok(Case {
            id: format!("drawn{seed}"),
            quantity,
            group: group.name(),
            expected: known.value,
            error: known.error,
            method: known.method.to_owned(),
            scene: Arc::new(group),
            at: Where { place, isa },
        });
    }
}

fn group(which: u64, draw: &mut Draw) -> (Group, String) {
    let radiance = draw.decades(0.1, 100.0);
    let rho = draw.within(0.2, 0.9);
    let name = |name: &str| name.to_owned();
    let two = |draw: &mut Draw, a: &str, b: &str| if draw.chance(0.5) { name(a) } else { name(b) };
    let lit = name("radiance");
    match which {
        0 => {
            let quantity = match draw.chance(0.4) {
                true => lit,
                false => format!("depth_{}", 1 + draw.below(12)),
            };
            (Group::Furnace(Furnace { rho: draw.within(0.05, 0.9), emission: radiance }), quantity)
        }
        1 => {
            let radius = draw.within(0.1, 1.0);
            let distance = radius * draw.within(1.3, 6.0);
            // At least a fifth of it above the horizon.
            let most = 90.0 + 0.6 * (radius / distance).asin().to_degrees();
            let beta_deg = draw.within(0.0, most);
            (Group::PlaneSphere(PlaneSphere { radius, distance, beta_deg, rho, radiance }), lit)
        }
        2 => {
            let [x, y] = [0; 2].map(|_| [draw.within(-2.0, 0.3), draw.within(0.4, 2.0)]);
            let height = draw.within(0.2, 3.0);
            (Group::PlaneRect(PlaneRect { x, y, height, rho, radiance }), lit)
        }
        3 => {
            let (radius, height) = (draw.within(0.1, 3.0), draw.within(0.2, 3.0));
            let aside = radius * draw.within(0.0, 0.8);
            (Group::PlaneDisk(PlaneDisk { radius, height, aside, rho, radiance }), lit)
        }
        4 => {
            let vertices = quad(draw).map(|p| p.to_array());
            (Group::PlaneQuad(PlaneQuad { vertices, rho, radiance }), lit)
        }
        5 => {
            let finish = finish(draw, [1e-3, 1.0]);
            (Group::Dome(Dome { finish, mu: draw.within(0.05, 1.0) }), lit)
        }
        6 => (Group::Ball(Ball { finish: finish(draw, [1e-2, 1.0]) }), name("mean_radiance")),
        7 => {
            let finish = finish(draw, [1e-2, 1.0]);
            let mu: f64 = draw.within(0.15, 1.0);
            let mirrored = DVec3::new(-(1.0 - mu * mu).sqrt(), 0.0, mu) * 2.0;
            let mut centre = mirrored.to_array().map(|x| x + draw.within(-0.3, 0.3));
            centre[2] = centre[2].abs() + 0.3;
            (Group::SpecRect(SpecRect { finish, mu, centre, radiance }), lit)
        }
        8 => {
            let finish = finish(draw, [1e-2, 1.0]);
            let sphere = SpecSphere {
                finish,
                mu: draw.within(0.15, 1.0),
                distance: draw.within(2.0, 4.0),
                radius: draw.within(0.2, 0.6),
                beta: draw.within(0.1, 1.1),
                phi: PI + draw.within(-0.3, 0.3),
                radiance,
            };
            (Group::SpecSphere(sphere), lit)
        }
        9 => {
            let Finish { model, param, .. } = finish(draw, [3e-4, 0.1]);
            (Group::Mirror(Mirror { model, param, mu: draw.within(0.2, 0.95) }), lit)
        }
        10 => {
            let parallel_planes = ParallelPlanes {
                height: draw.within(0.5, 2.0),
                albedo: [draw.within(0.1, 0.9), draw.within(0.1, 0.9)],
                emission: draw.within(0.5, 3.0),
            };
            (Group::ParallelPlanes(parallel_planes), two(draw, "plate1", "plate2"))
        }
        11 => {
            let mut wall = || [draw.within(0.1, 0.9), draw.within(0.1, 2.0)];
            let (inner, outer) = (wall(), wall());
            let radius = draw.within(0.1, 0.95);
            (Group::Concentric(Concentric { radius, inner, outer }), two(draw, "inner", "outer"))
        }
        12 => {
            let sphere = Integrating {
                rho: draw.within(0.2, 0.9),
                fraction: draw.decades(3e-3, 0.1),
                emission: draw.within(1.0, 50.0),
            };
            (Group::Integrating(sphere), two(draw, "wall", "cap"))
        }
        _ => {
            let finish = finish(draw, [0.3, 1.0]);
            let mu = draw.within(0.15, 1.0);
            (Group::Cavity(Cavity { finish }), format!("mu_{mu}"))
        }
    }
}

/// Any model, an alpha within these, and less than white.
fn finish(draw: &mut Draw, [low, high]: [f64; 2]) -> Finish {
    let model = draw.one(&Model::ALL);
    let alpha = draw.decades(low, high);
    let param = if model == Model::Phong { 2.0 / (alpha * alpha) - 2.0 } else { alpha };
    Finish { model, param, kd: draw.within(0.0, 0.5), ks: draw.within(0.02, 0.5) }
}

/// A rectangle that the origin sees well enough; the horizon may cut it.
fn quad(draw: &mut Draw) -> [DVec3; 4] {
    loop {
        let mut vector = |low: f64| {
            let [x, y] = [draw.within(-1.0, 1.0), draw.within(-1.0, 1.0)];
            DVec3::new(x, y, draw.within(low, 1.5))
        };
        let (centre, u, v) = (vector(0.1), vector(-1.0), vector(-1.0));
        let v = v.reject_from(u);
        let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
        let off = u.cross(v).normalize().dot(centre).abs();
        if off > 0.15 && factors::polygon(&corners) > 0.01 {
            return corners;
        }
    }
}
