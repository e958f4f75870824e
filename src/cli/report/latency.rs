//! `burnish report latency`: how soon a change is seen.

use super::{Scenes, Threads};
use crate::cli::snapshots::next;
use crate::cli::{Failure, print, scene, values};
use burnish::brdf::Roughness;
use burnish::film::REL_MSE_FLOOR;
use burnish::picture::Tone;
use burnish::progressive::{Params, Session, Snapshot, TILE};
use std::path::Path;
use std::time::{Duration, Instant};

/// Measures the time from a change of roughness to the tone-mapped picture that shows it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report latency table.scn --size 1600x1200 --changes 200
  burnish report latency cornell --threads 2")]
pub(super) struct Args {
    #[command(flatten)]
    scenes: Scenes,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = values::size)]
    size: [u32; 2],
    /// How many changes.
    #[arg(long, value_name = "N", default_value_t = 200,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    changes: u32,
    #[command(flatten)]
    threads: Threads,
}

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes.each().try_for_each(|path| measure(args, path))
}

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let loaded = scene::load(path)?;
    let mut params = Params::new(loaded.scene);
    params.size = args.size;
    let threads = args.threads.threads;
    let session = Session::start(params.clone(), Session::MAX_PASSES, threads, || {})
        .map_err(Failure::new)?;
    let mut screen = Screen::new();
    let (mut times, mut first) = (Vec::new(), None);
    for change in 0..args.changes {
        watch(&session, &mut screen, pause_before(change))?;
        params = params.with_roughness(roughness(change)?);
        let (time, snapshot) = change_to_picture(&session, &params, &mut screen)?;
        times.push(time);
        first = Some(snapshot);
    }
    let [w, h] = params.size;
    let (changes, threads) = (args.changes, values::worker_count(threads));
    print(format_args!("{changes} changes of roughness, {w}x{h}, {threads} worker threads"))?;
    print(summary("first changed picture, coarse or fine, tone-mapped", &mut times))?;
    if let Some(first) = first.filter(|s| s.passes == 0) {
        let truth = after_passes(&session, first.epoch)?;
        let [size, paths, error] = coarse_error(&first, &truth);
        print(format_args!(
            "its picture after the last change: blocks of {size} pixels, {paths} paths, relMSE \
             {error:.1e} against {JUDGE} passes averaged over its blocks"
        ))?;
    }
    print("presentation by the window system is not included")
}

/// Passes of the picture that a coarse one is held against. Over a block it has hundreds of samples
/// for one of the coarse picture.
const JUDGE: u64 = 4;

/// The picture of an epoch after `passes`.
fn after_passes(session: &Session, epoch: u64) -> Result<Snapshot, Failure> {
    loop {
        if let Some(snapshot) = next(session, PATIENCE)?
            && snapshot.epoch == epoch
            && snapshot.passes >= JUDGE
        {
            return Ok(snapshot);
        }
    }
}

/// Side of the blocks of a coarse picture, how many they are, and their relative mean square error,
/// `mean((x - r)² / (r² + 0.01))` over blocks and channels, r being the other's mean over the block.
fn coarse_error(coarse: &Snapshot, truth: &Snapshot) -> [f64; 3] {
    let side = coarse.tiles.iter().flatten().map(|tile| tile.block).max().unwrap_or(1) as usize;
    let (x, r) = (coarse.mean(), truth.mean());
    let (width, height) = (x.width as usize, x.height as usize);
    let (mut sum, mut blocks) = (0.0, 0.0);
    for top in (0..height).step_by(side) {
        for left in (0..width).step_by(side) {
            let rows = top..(top + side).min(height);
            let count = (rows.len() * side.min(width - left)) as f64;
            let places =
                rows.flat_map(|y| (left..(left + side).min(width)).map(move |x| y * width + x));
            for c in 0..3 {
                let light = |i: usize| f64::from(r.pixels[i][c]);
                let mean = places.clone().map(light).sum::<f64>() / count;
                let off = f64::from(x.pixels[top * width + left][c]) - mean;
                sum += off * off / (mean * mean + REL_MSE_FLOOR) / 3.0;
            }
            blocks += 1.0;
        }
    }
    [side as f64, blocks, sum / blocks]
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
) -> Result<(f64, Snapshot), Failure> {
    let start = Instant::now();
    let epoch = session.set(params.clone()).map_err(Failure::new)?;
    while start.elapsed() < PATIENCE {
        if let Some(snapshot) = next(session, PATIENCE)? {
            screen.show(&snapshot);
            if snapshot.epoch >= epoch {
                return Ok((start.elapsed().as_secs_f64(), snapshot));
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
