//! `--stats`: what a render took and what came of it, for scripts.

use super::Failure;
use burnish::picture::{Picture, replace_file};
use serde::Serialize;
use std::path::Path;

/// One render. Times are in seconds.
#[derive(Debug, Serialize)]
pub(super) struct Stats {
    /// Reading the scene's files.
    pub(super) load_s: f64,
    /// Building the tree.
    pub(super) build_s: f64,
    /// From the start of the program, or of its turn among several, to the first picture in which
    /// every pixel has a sample; null when the render ended before.
    pub(super) first_image_s: Option<f64>,
    /// Rendering alone.
    pub(super) render_s: f64,
    /// Samples that every pixel has at least.
    pub(super) passes: u64,
    /// Camera paths.
    pub(super) paths: u64,
    /// Rays of all kinds.
    pub(super) rays: u64,
    /// Most memory the program held; null where the system does not tell.
    pub(super) peak_mib: Option<f64>,
    /// Estimated relative error of the picture; null before there is an estimate.
    pub(super) est_rel_error: Option<f64>,
    /// Its 95 % limits.
    pub(super) est_rel_error_limits: Option<[f64; 2]>,
    /// Whether these figures can be relied on.
    pub(super) est_reliable: bool,
    /// Mean radiance over the picture.
    pub(super) mean: [f64; 3],
    /// Samples left out because they were NaN or infinite.
    pub(super) nonfinite: u64,
    /// Paths ended by the safety caps on their length and throughput.
    pub(super) capped: u64,
    pub(super) model: &'static str,
    /// How light was found, and which microfacet normals were drawn.
    pub(super) strategy: &'static str,
    pub(super) normals: &'static str,
    /// The mistake made on purpose; null for none.
    pub(super) erratum: Option<&'static str>,
    pub(super) seed: u64,
    /// How many neighbouring paths shared what they found; 1 for none.
    pub(super) group: u32,
    /// Instruction set of the traversal.
    pub(super) isa: &'static str,
    pub(super) version: &'static str,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Worker threads.
    pub(super) threads: usize,
}

impl Stats {
    /// As a JSON object, one field a line.
    pub(super) fn write(&self, path: &Path) -> Result<(), Failure> {
        replace_file(path, |mut sink| {
            serde_json::to_writer_pretty(&mut sink, self)?;
            sink.write_all(b"\n")
        })
        .map_err(Failure::new)
    }
}

/// Mean radiance of each channel.
pub(super) fn mean(picture: &Picture) -> [f64; 3] {
    let pixels = picture.pixels.len().max(1) as f64;
    let mut sum = [0.0; 3];
    for pixel in &picture.pixels {
        for (sum, &c) in sum.iter_mut().zip(pixel) {
            *sum += f64::from(c);
        }
    }
    sum.map(|s| s / pixels)
}

/// Most memory this process ever held, in MiB. Linux alone tells, in a file that is not one.
pub(super) fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_per_channel() {
        let pixels = vec![[1.0, 2.0, 3.0], [3.0, 2.0, 0.0]];
        assert_eq!(mean(&Picture { width: 2, height: 1, pixels }), [2.0, 2.0, 1.5]);
        assert_eq!(mean(&Picture::black(0, 0)), [0.0; 3]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_at_least_what_is_held() {
        let held = vec![1u8; 32 << 20];
        assert!(held.iter().all(|&b| b == 1));
        assert!(peak_mib().unwrap() > 32.0);
    }
}
