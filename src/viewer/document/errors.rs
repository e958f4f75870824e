//! How the error of each picture of a scene fell while it was traced: bounded histories of the
//! snapshots' estimates, for a plot and for the time still to go.

use crate::viewer::style::numbers::digits;
use burnish::film::Interval;
use burnish::progressive::{ErrorEstimate, Params, Snapshot};
use std::fmt::Write;
use std::sync::Arc;

/// An error at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// Seconds of tracing this picture, pauses and other pictures' turns not counted.
    pub(crate) seconds: f64,
    /// Whole passes.
    pub(crate) passes: u64,
    /// Relative, as a part of one; above 0.
    pub(crate) error: f64,
    /// Its 95 % limits.
    pub(crate) limits: Interval,
    /// Whether it can be relied on.
    pub(crate) reliable: bool,
}

/// The points of one picture in the order of time: at most one in each 1/32 of a decade of seconds,
/// the newest that fell there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {
    points: Vec<Point>,
}

impl History {
    /// Points of a decade of time.
    const PER_DECADE: f64 = 32.0;
    /// Decades of seconds; what is beyond counts to the first or last step.
    const DECADES: [f64; 2] = [-3.0, 9.0];
    /// More points than this there never are.
    #[cfg(test)]
    pub(crate) const MOST: usize = 385;

    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    pub(crate) fn newest(&self) -> Option<&Point> {
        self.points.last()
    }

    /// Forgets what was, if the picture has been started anew: it has had less time than it had.
    fn begin(&mut self, seconds: f64) {
        if self.newest().is_some_and(|newest| seconds < newest.seconds) {
            self.points.clear();
        }
    }

    /// Takes a point in. One that has no place in logarithms is left out.
    fn add(&mut self, point: Point) {
        let has_place = |x: f64| x > 0.0 && x.is_finite();
        if !has_place(point.seconds) || !has_place(point.error) {
            return;
        }
        self.begin(point.seconds);
        match self.points.last_mut() {
            Some(last) if step(last.seconds) == step(point.seconds) => *last = point,
            _ => self.points.push(point),
        }
    }

    /// The error after `seconds` of tracing, along straight lines between the points' logarithms; `None`
    /// before the first and after the last.
    pub(crate) fn at(&self, seconds: f64) -> Option<f64> {
        let after = self.points.partition_point(|p| p.seconds < seconds);
        let next = self.points.get(after)?;
        if next.seconds == seconds {
            return Some(next.error);
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        let [from, to, at] = [last.seconds, next.seconds, seconds].map(f64::ln);
        let part = (at - from) / (to - from);
        Some((last.error.ln() + part * (next.error.ln() - last.error.ln())).exp())
    }
}

/// The step of time that a moment belongs to.
fn step(seconds: f64) -> i64 {
    let [first, last] = History::DECADES;
    (seconds.log10().clamp(first, last) * History::PER_DECADE).floor() as i64
}

/// The error of one picture over time.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) params: Params,
    /// By the picture's own replicates.
    pub(crate) estimated: History,
    /// Against the reference.
    pub(crate) truth: History,
    /// Passes and seconds when it was last seen.
    seen: (u64, f64),
}

/// The curves of the pictures of one scene, the one that was traced last at the end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Curves {
    curves: Vec<Curve>,
}

impl Curves {
    /// More pictures than this are not remembered.
    pub(crate) const MOST: usize = 24;
    /// Passes and seconds from which on a picture is remembered: one that had less was a step of a drag.
    const WORTH: (u64, f64) = (32, 1.0);

    /// Adds the error estimate of a snapshot of these parameters.
    pub(crate) fn note(&mut self, params: &Params, snapshot: &Snapshot) {
        let curve = self.curve(params);
        curve.seen = (snapshot.passes, snapshot.seconds);
        curve.estimated.begin(snapshot.seconds);
        curve.truth.begin(snapshot.seconds);
        if let Some(ErrorEstimate { relative, reliable, .. }) = snapshot.error {
            let (seconds, passes) = (snapshot.seconds, snapshot.passes);
            let (error, limits) = (relative.value, relative.interval);
            curve.estimated.add(Point { seconds, passes, error, limits, reliable });
        }
    }

    /// Adds the distance of such a snapshot from the reference.
    pub(crate) fn note_truth(&mut self, params: &Params, seconds: f64, passes: u64, error: f64) {
        // What was left, and forgotten, meanwhile is not begun again.
        let Some(curve) = self.curves.iter_mut().find(|c| c.params == *params) else { return };
        let limits = Interval { low: error, high: error };
        // An answer that comes late is of a picture that may have been started anew.
        if curve.truth.newest().is_none_or(|newest| newest.seconds <= seconds) {
            curve.truth.add(Point { seconds, passes, error, limits, reliable: true });
        }
    }

    /// Forgets all distances from a reference.
    pub(crate) fn forget_truth(&mut self) {
        self.curves.iter_mut().for_each(|curve| curve.truth = History::default());
    }

    /// The curve of these parameters.
    pub(crate) fn of(&self, params: &Params) -> Option<&Curve> {
        self.curves.iter().find(|c| c.params == *params)
    }

    /// The curves of the same view: of these parameters first, then of the same materials in the order of
    /// the models, then the others, the latest first.
    pub(crate) fn of_view(&self, params: &Params) -> Vec<&Curve> {
        let same_view = |c: &&Curve| {
            let p = &c.params;
            p.camera == params.camera && p.size == params.size && !c.estimated.points.is_empty()
        };
        let mut all: Vec<&Curve> = self.curves.iter().rev().filter(same_view).collect();
        let rank = |c: &&Curve| {
            let p = &c.params;
            let other = *p != Params { model: p.model, ..params.clone() };
            let model = burnish::brdf::Model::ALL.iter().position(|&m| m == p.model);
            (*p != *params, other, model.filter(|_| !other))
        };
        all.sort_by_key(rank);
        all
    }

    /// The curve of these parameters, at the end: begun if there is none.
    fn curve(&mut self, params: &Params) -> &mut Curve {
        let known = self.curves.iter().position(|c| c.params == *params);
        let curve = match known {
            Some(at) => self.curves.remove(at),
            None => {
                let same_scene = |c: &Curve| Arc::ptr_eq(&c.params.scene, &params.scene);
                let (passes, seconds) = Curves::WORTH;
                let worth = |c: &Curve| c.seen.0 >= passes || c.seen.1 >= seconds;
                self.curves.retain(|c| same_scene(c) && worth(c));
                let surplus = (self.curves.len() + 1).saturating_sub(Curves::MOST);
                self.curves.drain(..surplus);
                let params = params.clone();
                Curve {
                    params,
                    estimated: History::default(),
                    truth: History::default(),
                    seen: (0, 0.0),
                }
            }
        };
        self.curves.push(curve);
        let last = self.curves.len() - 1;
        &mut self.curves[last]
    }
}

/// The name of a picture that tells it from another one of the scene: "GGX 0.141", "GGX 0.02 to 0.3, BRDF
/// sampling".
pub(crate) fn name(p: &Params, other: &Params) -> String {
    let mut name = p.model.title().to_owned();
    let alphas = p.materials.iter().filter(|m| m.ks.iter().any(|&c| c > 0.0));
    let [low, high] = alphas
        .map(|m| m.roughness.alpha())
        .fold([f64::INFINITY, 0.0], |[low, high], a| [low.min(a), high.max(a)]);
    let _ = match (low, high) {
        (low, _) if low.is_infinite() => Ok(()),
        (low, high) if low == high => write!(name, " {}", digits(low, 3)),
        (low, high) => write!(name, " {} to {}", digits(low, 2), digits(high, 2)),
    };
    let colours = |p: &Params| -> Vec<[[f32; 3]; 3]> {
        p.materials.iter().map(|m| [m.kd, m.ks, m.emission]).collect()
    };
    let erratum = p.erratum.map_or("no bug".to_owned(), |e| e.name().to_owned());
    let depth = p.max_depth.map_or("any depth".to_owned(), |d| format!("depth {d}"));
    for (differs, words) in [
        (colours(p) != colours(other), "other colours".to_owned()),
        (p.strategy != other.strategy, p.strategy.title().to_owned()),
        (p.normals != other.normals, p.normals.title().to_owned()),
        (p.max_depth != other.max_depth, depth),
        (p.erratum != other.erratum, erratum),
        (p.seed != other.seed, format!("seed {}", p.seed)),
    ] {
        if differs {
            let _ = write!(name, ", {words}");
        }
    }
    name
}

/// All points of these curves as a table in CSV.
pub(crate) fn csv(curves: &[&Curve], shown: &Params) -> String {
    let mut text =
        "picture,figure,seconds,passes,relative_error,low_95,high_95,reliable\n".to_owned();
    for curve in curves {
        // Names have commas.
        let name = name(&curve.params, shown);
        for (figure, history) in [("estimated", &curve.estimated), ("true", &curve.truth)] {
            for p in history.points() {
                let Interval { low, high } = p.limits;
                let _ = writeln!(
                    text,
                    "\"{name}\",{figure},{:.6},{},{:.6e},{low:.6e},{high:.6e},{}",
                    p.seconds, p.passes, p.error, p.reliable
                );
            }
        }
    }
    text
}

#[cfg(test)]
pub(super) mod tests;
