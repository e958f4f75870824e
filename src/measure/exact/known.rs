//! The answer to any scene of a group, by its parameters: what the table has for some, computed here
//! for all, in double precision and without a random number.

use super::ExactError;
use super::glossy::Finish;
use super::group::Group;
use super::lobes::SeenLobe;
use super::quantity::number_in;
use super::{factors, transport};
use glam::DVec3;

/// A radiance, how far it may be off, and how it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The radiance, or mean radiance.
    pub value: f64,
    /// Bound of its absolute error: for quadratures three times what fewer points change, if that
    /// is more than rounding errors.
    pub error: f64,
    /// In a few words.
    pub method: &'static str,
}

/// By a formula: right but for rounding errors.
fn closed(value: f64, method: &'static str) -> Known {
    Known { value, error: 1e-13 * value.abs(), method }
}

/// By a rule of more points and one of fewer.
fn by_points(fine: f64, coarse: f64, method: &'static str) -> Known {
    let error = (3.0 * (fine - coarse).abs()).max(1e-9 * fine.abs());
    Known { value: fine, error, method }
}

impl Group {
    /// `None` where light grows without end.
    pub(super) fn known(&self, quantity: &str) -> Result<Option<Known>, ExactError> {
        let strange = || ExactError::Quantity(quantity.to_owned());
        Ok(Some(match self {
            Group::Furnace(s) => {
                let sum = match quantity {
                    "radiance" => 1.0 / (1.0 - s.rho),
                    _ => {
                        let depth = number_in(quantity, "depth_")? as i32;
                        (0..=depth).map(|k| s.rho.powi(k)).sum()
                    }
                };
                closed(s.emission * sum, "closed form: a geometric series")
            }
            Group::PlaneSphere(s) => {
                let of = |points| {
                    let beta = s.beta_deg.to_radians();
                    s.rho * s.radiance * factors::sphere(s.radius, s.distance, beta, points)
                };
                by_points(of(100), of(60), "1D quadrature of the part above the horizon")
            }
            Group::PlaneRect(s) => {
                let ([x0, x1], [y0, y1]) = (s.x, s.y);
                let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
                    .map(|[x, y]| DVec3::new(x, y, s.height));
                closed(s.rho * s.radiance * factors::polygon(&corners), "Lambert's polygon formula")
            }
            Group::PlaneDisk(s) => {
                let factor = factors::disc(s.radius, s.height, s.aside);
                closed(s.rho * s.radiance * factor, "closed form: Howell B-13")
            }
            Group::PlaneQuad(s) => {
                let corners = s.vertices.map(DVec3::from_array);
                let value = s.rho * s.radiance * factors::polygon(&corners);
                closed(value, "Lambert's polygon formula, cut at the horizon")
            }
            Group::Dome(s) => {
                let value = SeenLobe::new(&s.finish, s.mu)?.in_the_open();
                Known { value, error: 1e-9 + 1e-8 * value, method: "2D quadrature of the BRDF" }
            }
            Group::Ball(s) => {
                let seen = SeenLobe::new(&s.finish, 1.0)?;
                by_points(seen.ball(48), seen.ball(32), "3D quadrature of the BRDF")
            }
            Group::SpecRect(s) => {
                let edges = [DVec3::X * 0.5, DVec3::Y * 0.4];
                let centre = DVec3::from_array(s.centre);
                square(&s.finish, s.mu, centre, edges, s.radiance)?
            }
            Group::Mirror(s) => {
                let edges = [DVec3::X * 0.5, DVec3::Y * 0.5];
                square(&s.finish(), s.mu, s.centre(), edges, 1.0)?
            }
            Group::SpecSphere(s) => {
                let seen = SeenLobe::new(&s.finish, s.mu)?;
                let ((sin, cos), (sin_phi, cos_phi)) = (s.beta.sin_cos(), s.phi.sin_cos());
                let towards = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
                let of = |panels| s.radiance * seen.sphere(towards, s.radius / s.distance, panels);
                by_points(of(32), of(22), "2D quadrature over the lamp's solid angle")
            }
            Group::ParallelPlanes(s) => {
                let which = match quantity {
                    "plate1" => 0,
                    "plate2" => 1,
                    _ => return Err(strange()),
                };
                let of = |points| {
                    s.emission * transport::parallel_planes(s.height, s.albedo, points)[which]
                };
                by_points(of(26), of(20), "Nyström's method")
            }
            Group::Concentric(s) => {
                // inner = e1 + r1 outer; outer = e2 + r2 (q² inner + (1 - q²) outer)
                let ([r1, e1], [r2, e2]) = (s.inner, s.outer);
                let q2 = s.radius * s.radius;
                let outer = (e2 + r2 * q2 * e1) / (1.0 - r2 * (1.0 - q2) - r2 * q2 * r1);
                let value = match quantity {
                    "inner" => e1 + r1 * outer,
                    "outer" => outer,
                    _ => return Err(strange()),
                };
                closed(value, "closed form: two equations")
            }
            Group::Integrating(s) => {
                let wall = s.rho * s.fraction * s.emission / (1.0 - s.rho);
                let value = match quantity {
                    "wall" => wall,
                    "cap" => s.emission + wall,
                    _ => return Err(strange()),
                };
                closed(value, "closed form: every wall gets alike")
            }
            Group::Cavity(s) => {
                let mu = number_in(quantity, "mu_")?;
                let of = |points, azimuths| transport::cavity(&s.finish, mu, points, azimuths);
                let (Some(fine), Some(coarse)) = (of(90, 14)?, of(60, 10)?) else {
                    return Ok(None);
                };
                let method = "Nyström's method, 1D integral equation";
                Known {
                    error: by_points(fine, coarse, method).error.max(1e-7),
                    value: fine,
                    method,
                }
            }
        }))
    }
}

/// A glossy surface under a rectangle.
fn square(
    finish: &Finish,
    mu: f64,
    centre: DVec3,
    edges: [DVec3; 2],
    radiance: f64,
) -> Result<Known, ExactError> {
    let seen = SeenLobe::new(finish, mu)?;
    let of = |points| radiance * seen.rectangle(centre, edges, points);
    Ok(by_points(of(14), of(9), "2D quadrature, graded towards the mirror's direction"))
}
