//! One pixel taken apart: what it sees, and which light makes it up.

use super::{Params, Replay};
use crate::film::{Figure, Interval, student};
use crate::math::Rgb;
use crate::math::sobol::REPLICATES;
use crate::scene::{FirstHit, MaterialId};
use crate::trace::{PathRecord, Tracer};

/// What a pixel's light is made of, by samples of the reference tracer.
///
/// These samples are the pixel's own: nothing is shared with neighbours, and every pixel gets as
/// many as were asked for. Their mean is that of the picture's pixel, their noise is not. They come
/// in [`PixelReport::RANDOMISATIONS`] independent randomisations, by whose spread the intervals are
/// told.
#[derive(Clone, Debug)]
pub struct PixelReport {
    /// Column and row, from the top left.
    pub pixel: [u32; 2],
    /// The surface behind the pixel's middle.
    pub first: Option<FirstHit>,
    /// How many samples there are.
    pub samples: u64,
    /// All of the light.
    pub total: ProbeEstimate,
    /// By the number of scattering events between camera and light, from 0, which is light seen
    /// directly. The last one holds that many and more; the list ends with the last that has any
    /// light.
    pub by_event: Vec<ProbeEstimate>,
    /// In the order of [`Technique::ALL`].
    pub by_technique: [ProbeEstimate; Technique::ALL.len()],
    /// Luminance of every sample, in their order.
    pub luminances: Vec<f32>,
    /// Directions that samples took at the first surface where that is of the material of
    /// [`PixelReport::first`]: unit, z being the shading normal, turned so that the viewer is in the
    /// half plane of x < 0, y = 0. The mirror direction is in that of x > 0.
    pub directions: Vec<[f32; 3]>,
    /// The sample of the greatest luminance, with the pass that it is of.
    pub brightest: (u64, PathRecord),
    /// The picture's own sample of its first pass, with those that it shared with.
    pub picture: Replay,
}

/// How light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// Seen by the camera directly.
    Seen,
    /// By sampling a light at a surface (next-event estimation).
    Light,
    /// By a direction sampled from the BRDF that hit an emitter or left for the environment.
    Brdf,
}

impl Technique {
    /// All of them.
    pub const ALL: [Technique; 3] = [Technique::Seen, Technique::Light, Technique::Brdf];

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Technique::Seen => "Seen directly",
            Technique::Light => "Light sampling",
            Technique::Brdf => "BRDF sampling",
        }
    }
}

/// Mean radiance of some of the light, in W/(m² sr).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeEstimate {
    /// Of each channel.
    pub rgb: [Figure; 3],
    /// Of the Rec. 709 luminance.
    pub luminance: Figure,
}

impl PixelReport {
    /// Independent randomisations of the samples.
    pub const RANDOMISATIONS: usize = 16;
    /// Scattering events that are told apart.
    pub const EVENTS: usize = 6;
    /// Passes of a replicate after which a new randomisation of its numbers begins.
    const BLOCK: u64 = 1 << 16;

    /// The pass whose numbers sample `i` has. Replicates of blocks of passes far apart are
    /// independent of each other; within each the samples are stratified.
    fn pass(i: u64) -> u64 {
        let (which, index) = (i % Self::RANDOMISATIONS as u64, i / Self::RANDOMISATIONS as u64);
        let (replicate, block) = (which % REPLICATES as u64, which / REPLICATES as u64);
        (block * Self::BLOCK + index) * REPLICATES as u64 + replicate
    }
}

/// Takes the pixel in column `x`, row `y` from the top apart by `samples` samples, rounded up to a
/// multiple of [`PixelReport::RANDOMISATIONS`] and at most 2^20. The same arguments give the same
/// bits. `None` for a pixel outside the picture.
pub fn probe(params: &Params, [x, y]: [u32; 2], samples: u64) -> Option<PixelReport> {
    let picture = Replay::new(params, [x, y], 0)?;
    let runs = PixelReport::RANDOMISATIONS as u64;
    let samples = samples.clamp(1, 1 << 20).div_ceil(runs) * runs;
    let middle = [x as f32 + 0.5, y as f32 + 0.5];
    let first = params.scene.first_hit(&params.camera, params.size, middle);
    let tracer = params.tracer();
    let mut sums = ProbeSums::new(first.map(|f| f.material));
    sums.trace(&tracer, [x, y], samples);
    let last = sums.by_event.iter().rposition(|e| e.any).map_or(0, |i| i + 1);
    let each = samples / runs;
    Some(PixelReport {
        pixel: [x, y],
        first,
        samples,
        total: sums.total.part(each),
        by_event: sums.by_event[..last].iter().map(|e| e.part(each)).collect(),
        by_technique: sums.by_technique.map(|t| t.part(each)),
        luminances: sums.luminances,
        directions: sums.directions,
        brightest: sums.brightest?,
        picture,
    })
}

/// What one path brings, by the number of scattering events and by technique.
pub(super) fn contributions(path: &PathRecord) -> impl Iterator<Item = (usize, Technique, Rgb)> {
    let found = |events: usize| if events == 0 { Technique::Seen } else { Technique::Brdf };
    let surfaces = path.vertices.iter().enumerate().flat_map(move |(i, vertex)| {
        [(i, found(i), vertex.emitted), (i + 1, Technique::Light, vertex.direct)]
    });
    let events = path.vertices.len();
    let escape = path.escape.map(|e| (events, found(events), e.found));
    surfaces.chain(escape)
}

/// Sums of some of the light, by randomisation.
#[derive(Clone, Copy, Default)]
struct ProbeSum {
    runs: [[f64; 3]; PixelReport::RANDOMISATIONS],
    any: bool,
}

impl ProbeSum {
    fn add(&mut self, run: usize, found: Rgb) {
        for (sum, c) in self.runs[run].iter_mut().zip(<[f32; 3]>::from(found)) {
            *sum += f64::from(c);
        }
        self.any |= !found.is_black();
    }

    /// Means of `each` samples a randomisation.
    fn part(&self, each: u64) -> ProbeEstimate {
        let of = |weights: [f64; 3]| {
            figure(self.runs.map(|rgb| {
                let sum: f64 = rgb.iter().zip(weights).map(|(c, w)| c * w).sum();
                sum / each as f64
            }))
        };
        let rgb = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(of);
        ProbeEstimate { rgb, luminance: of([0, 1, 2].map(luminance_of)) }
    }
}

/// A channel's weight in the luminance.
fn luminance_of(channel: usize) -> f64 {
    let mut one = [0.0; 3];
    one[channel] = 1.0;
    Rgb::from(one).luminance().into()
}

/// The mean of independent numbers, and where the truth lies (Student).
fn figure<const N: usize>(runs: [f64; N]) -> Figure {
    let n = N as f64;
    let value = runs.iter().sum::<f64>() / n;
    let squares: f64 = runs.iter().map(|x| (x - value).powi(2)).sum();
    let error = (squares / (n * (n - 1.0))).sqrt();
    // No spread leaves no doubt, with however few degrees of freedom.
    let reach = if error > 0.0 { error * student(n - 1.0) } else { 0.0 };
    Figure { value, interval: Interval { low: value - reach, high: value + reach } }
}

struct ProbeSums {
    material: Option<MaterialId>,
    total: ProbeSum,
    by_event: [ProbeSum; PixelReport::EVENTS],
    by_technique: [ProbeSum; Technique::ALL.len()],
    luminances: Vec<f32>,
    directions: Vec<[f32; 3]>,
    brightest: Option<(u64, PathRecord)>,
}

impl ProbeSums {
    fn new(material: Option<MaterialId>) -> ProbeSums {
        ProbeSums {
            material,
            total: ProbeSum::default(),
            by_event: Default::default(),
            by_technique: Default::default(),
            luminances: Vec::new(),
            directions: Vec::new(),
            brightest: None,
        }
    }

    fn trace(&mut self, tracer: &Tracer, pixel: [u32; 2], samples: u64) {
        let mut scratch = tracer.scratch();
        for i in 0..samples {
            let pass = PixelReport::pass(i);
            let path = tracer.record(pixel, pass, &mut scratch);
            self.add((i % PixelReport::RANDOMISATIONS as u64) as usize, pass, path);
        }
    }

    fn add(&mut self, run: usize, pass: u64, path: PathRecord) {
        self.total.add(run, path.value);
        for (events, technique, found) in contributions(&path) {
            self.by_event[events.min(PixelReport::EVENTS - 1)].add(run, found);
            self.by_technique[technique as usize].add(run, found);
        }
        if let Some(first) = path.vertices.first().filter(|v| Some(v.material) == self.material)
            && let Some([wo, wi]) = first.scattered
        {
            self.directions.push(turned(wo.into(), wi.into()));
        }
        let luminance = path.value.luminance();
        self.luminances.push(luminance);
        let most = self.brightest.as_ref().map(|(_, path)| path.value.luminance());
        if most.is_none_or(|most| luminance > most) {
            self.brightest = Some((pass, path));
        }
    }
}

/// `wi` turned about z, as takes `wo` to x < 0, y = 0.
fn turned(wo: [f32; 3], [x, y, z]: [f32; 3]) -> [f32; 3] {
    let across = wo[0].hypot(wo[1]);
    if across == 0.0 {
        return [x, y, z];
    }
    let [c, s] = [-wo[0] / across, -wo[1] / across];
    [c * x + s * y, c * y - s * x, z]
}

/// How often numbers above 0 fall within equal steps of their logarithm.
#[derive(Clone, Debug, PartialEq)]
pub struct LogHistogram {
    /// How many are not above 0, or not finite.
    pub rest: u64,
    /// Decadic logarithms of the lowest and highest edge, both whole.
    pub decades: [i32; 2],
    /// How many are in each step.
    pub counts: Vec<u64>,
}

impl LogHistogram {
    /// Decades at most; what is below the highest of them counts in the lowest step.
    const MOST: i32 = 12;

    /// Of these values, by a number of steps a decade.
    pub fn new(values: &[f32], steps: usize) -> LogHistogram {
        let logs = || values.iter().filter(|v| v.is_finite() && **v > 0.0).map(|v| v.log10());
        let found = logs().count() as u64;
        let rest = values.len() as u64 - found;
        if found == 0 || steps == 0 {
            return LogHistogram { rest, decades: [0, 0], counts: Vec::new() };
        }
        let (least, most) =
            logs().fold((f32::MAX, f32::MIN), |(least, most), v| (least.min(v), most.max(v)));
        let high = most.floor() as i32 + 1;
        let low = (least.floor() as i32).max(high - Self::MOST);
        let mut counts = vec![0; (high - low) as usize * steps];
        for log in logs() {
            let step = ((log - low as f32) * steps as f32).max(0.0) as usize;
            let last = counts.len() - 1;
            counts[step.min(last)] += 1;
        }
        LogHistogram { rest, decades: [low, high], counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_samples_have_the_same_numbers() {
        let mut seen = std::collections::HashSet::new();
        assert!((0..1 << 16).all(|i| seen.insert(PixelReport::pass(i))));
        // The first of each randomisation: all replicates of four blocks.
        let first: Vec<u64> = (0..16).map(PixelReport::pass).collect();
        assert_eq!(first[..5], [0, 1, 2, 3, 1 << 18]);
        assert_eq!(PixelReport::pass(16), 4);
    }

    #[test]
    fn an_interval_is_students() {
        let figure = figure([1.0, 2.0, 3.0, 4.0]);
        // Deviation sqrt(5 / 3), of four: 0.6455; t of three degrees of freedom 3.1824.
        assert_eq!(figure.value, 2.5);
        assert!((figure.interval.high - (2.5 + 0.645_497 * 3.182_446)).abs() < 1e-5);
        let certain = super::figure([0.5; 16]);
        assert_eq!((certain.interval.low, certain.interval.high), (0.5, 0.5));
    }

    #[test]
    fn the_viewer_is_turned_to_the_left() {
        for phi in [0.0f32, 0.3, 2.0, -3.0] {
            let wo = [0.6 * phi.cos(), 0.6 * phi.sin(), 0.8];
            let [x, y, z] = turned(wo, wo);
            assert!((x + 0.6).abs() < 1e-6 && y.abs() < 1e-6 && z == 0.8, "{phi}");
            let mirror = [-wo[0], -wo[1], wo[2]];
            assert!((turned(wo, mirror)[0] - 0.6).abs() < 1e-6, "{phi}");
        }
        assert_eq!(turned([0.0, 0.0, 1.0], [0.6, 0.0, 0.8]), [0.6, 0.0, 0.8]);
    }

    #[test]
    fn a_histogram_counts_everything_once() {
        let values = [0.0, f32::NAN, 0.02, 0.021, 0.3, 5.0, 9.99, 1.0];
        let histogram = LogHistogram::new(&values, 2);
        // Edges at 0.01, 0.0316, 0.1, 0.316, 1, 3.16, 10.
        assert_eq!(histogram.rest, 2);
        assert_eq!(histogram.decades, [-2, 1]);
        assert_eq!(histogram.counts, [2, 0, 1, 0, 1, 2]);
        let wide = LogHistogram::new(&[1e-30, 1.0], 1);
        assert_eq!((wide.decades, wide.counts.iter().sum::<u64>()), ([-11, 1], 2));
        assert!(LogHistogram::new(&[0.0], 4).counts.is_empty());
    }
}
