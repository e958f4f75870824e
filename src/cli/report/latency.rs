//! `burnish report --latency`: how soon a change is seen.

use super::Args;
use crate::cli::snapshots::next;
use crate::cli::{Failure, print, scene, values};
use burnish::brdf::Roughness;
use burnish::picture::Tone;
use burnish::progressive::{Params, Session, Snapshot, TILE};
use std::path::Path;
use std::time::{Duration, Instant};

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes().into_iter().try_for_each(|path| measure(args, path))
}

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let loaded = scene::load(path)?;
    let mut params = Params::new(loaded.scene);
    params.size = args.size.unwrap_or([1600, 1200]);
    let session = Session::start(params.clone(), Session::MAX_PASSES, args.threads, || {})
        .map_err(Failure::new)?;
    let mut screen = Screen::new();
    let mut times = Vec::new();
    for change in 0..args.changes {
        watch(&session, &mut screen, pause_before(change))?;
        params = params.with_roughness(roughness(change)?);
        times.push(change_to_picture(&session, &params, &mut screen)?);
    }
    let [w, h] = params.size;
    let (changes, threads) = (args.changes, values::worker_count(args.threads));
    print(format_args!("{changes} changes of roughness, {w}x{h}, {threads} worker threads"))?;
    print(summary("first changed picture, coarse or fine, tone-mapped", &mut times))?;
    print("presentation by the window system is not included")
}

/// The roughness after the n-th change: all over the useful range, never twice in a row the same.
fn roughness(n: u32) -> Result<Roughness, Failure> {
    let place = (0.5 + f64::from(n) * GOLDEN).fract();
    Roughness::from_alpha(0.02 * 25f64.powf(place)).map_err(Failure::new)
}

/// Between two changes, 20 to 80 ms: long enough for the workers to be amid something, and at no
/// fixed point of it.
fn pause_before(n: u32) -> Duration {
    Duration::from_secs_f64(0.020 + 0.060 * (f64::from(n) * GOLDEN).fract())
}

/// Its multiples spread evenly, in an order without a pattern.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// What stands in for the window: the tiles of a snapshot become the codes of a texture.
struct Screen {
    codes: Vec<[u8; 4]>,
}

impl Screen {
    fn new() -> Screen {
        Screen { codes: vec![[0; 4]; (TILE * TILE) as usize] }
    }

    /// Tone-maps what changed since the last snapshot received.
    fn show(&mut self, snapshot: &Snapshot) {
        for tile in snapshot.dirty.iter().filter_map(|&i| snapshot.tiles.get(i as usize)?.as_ref())
        {
            Tone::default().rgba8(&tile.mean, &mut self.codes);
            // Nothing reads the codes; they must be made all the same.
            std::hint::black_box(&self.codes);
        }
    }
}

/// Shows what comes for so long, as a window in which nothing else happens.
fn watch(session: &Session, screen: &mut Screen, time: Duration) -> Result<(), Failure> {
    let end = Instant::now() + time;
    while let Some(rest) = end.checked_duration_since(Instant::now()) {
        if let Some(snapshot) = next(session, rest)? {
            screen.show(&snapshot);
        }
    }
    Ok(())
}

/// Seconds from the order to the codes of the first picture that obeys it.
fn change_to_picture(
    session: &Session,
    params: &Params,
    screen: &mut Screen,
) -> Result<f64, Failure> {
    let start = Instant::now();
    let epoch = session.set(params.clone()).map_err(Failure::new)?;
    while start.elapsed() < PATIENCE {
        if let Some(snapshot) = next(session, PATIENCE)? {
            screen.show(&snapshot);
            if snapshot.epoch >= epoch {
                return Ok(start.elapsed().as_secs_f64());
            }
        }
    }
    Err(Failure::new(format_args!("no picture within {} s of a change", PATIENCE.as_secs())))
}

const PATIENCE: Duration = Duration::from_secs(60);

/// Median, 95th percentile and largest, in milliseconds.
fn summary(name: &str, seconds: &mut [f64]) -> String {
    seconds.sort_by(f64::total_cmp);
    let [p50, p95, max] = [0.50, 0.95, 1.0].map(|share| 1e3 * quantile(seconds, share));
    format!("{name}: p50 {p50:.1} ms, p95 {p95:.1} ms, max {max:.1} ms")
}

/// The smallest value that at least this share of the sorted values do not exceed.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_seen() {
        let values: Vec<f64> = (1..=200).map(f64::from).collect();
        assert_eq!([0.5, 0.95, 1.0].map(|s| quantile(&values, s)), [100.0, 190.0, 200.0]);
        assert_eq!(quantile(&[7.0], 0.5), 7.0);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn every_change_is_one_and_every_pause_is_in_range() {
        for n in 0..1000 {
            assert_ne!(roughness(n).unwrap(), roughness(n + 1).unwrap());
            assert!((20..=80).contains(&pause_before(n).as_millis()));
        }
    }
}
