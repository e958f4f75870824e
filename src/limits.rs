//! What is too large, and what memory there is: every limit of the program in one place.
//!
//! A program that asks for memory that is not there ends without a word, and one that asks for more
//! than the machine has makes it useless for all others. So whatever grows with its input is
//! [estimated and compared](fits) before it is asked for, and refused with both numbers.

use std::fmt;
use std::fs;
use std::path::Path;
use thiserror::Error;

/// Largest width and height of a picture, rendered or read.
pub const PICTURE_SIDE: u32 = 32_768;
/// Largest width and height that `screen` may ask for in a scene.
pub const SCREEN_SIDE: u32 = 16_384;
/// Largest file of a scene, a model or its materials, in bytes.
pub const FILE_BYTES: u64 = 4 << 30;
/// Most triangles of a scene, and most vertices.
pub const TRIANGLES: usize = 1 << 30;
/// Longest text beside the pixels of a picture once it is unpacked, in bytes.
pub const TEXT_BYTES: usize = 8 << 20;
/// Most bytes that the samples of a picture may come to, whatever the length of its file.
pub const EXR_FREE_BYTES: u64 = 256 << 20;
/// Most times the length of its file that they may come to beyond that.
pub const EXR_EXPANSION: u64 = 100;
/// Largest table of directions, in bytes.
pub const TABLE_BYTES: u64 = 256 << 20;
/// Bytes of memory that a byte of a scene or model takes at most while it is read: measured at 7 to
/// 15, of binary PLY to lines of short numbers.
pub const READ_FACTOR: u64 = 16;

/// All limits in words, for the help and the README: what, how much.
pub fn table() -> Vec<(&'static str, String)> {
    vec![
        ("sides of a picture", format!("{PICTURE_SIDE} pixels, rendered or read")),
        ("`screen` in a scene", format!("{SCREEN_SIDE} pixels a side")),
        ("a file of a scene", format!("{}", Bytes(FILE_BYTES))),
        ("triangles and vertices of a scene", format!("{TRIANGLES} each")),
        ("a table for `brdf --eval`", format!("{}", Bytes(TABLE_BYTES))),
        ("text beside a picture's pixels", format!("{}", Bytes(TEXT_BYTES as u64))),
        (
            "samples of an OpenEXR picture",
            format!("{}, or {EXR_EXPANSION} times its file if that is more", Bytes(EXR_FREE_BYTES)),
        ),
        (
            "memory",
            "what the machine, the control group and `ulimit -v` leave free; what does not fit is \
             refused with what it needs"
                .to_owned(),
        ),
    ]
}

/// A number of bytes in words: "1.5 GiB".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let all = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
        match all.iter().find(|(power, _)| self.0 >> power > 0) {
            Some((power, unit)) => {
                let number = self.0 as f64 / (1u64 << power) as f64;
                let digits = usize::from(number.fract() != 0.0);
                write!(f, "{number:.digits$} {unit}")
            }
            None => write!(f, "{} bytes", self.0),
        }
    }
}

/// What this process may still take, and who says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Number of bytes.
    pub bytes: u64,
    /// Whose limit that is.
    pub by: &'static str,
}

/// Something would need more memory than there is.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{what} needs about {} of memory, and {} are free ({})", Bytes(*.need), Bytes(.free.bytes), .free.by)]
pub struct TooLarge {
    /// What.
    pub what: String,
    /// In bytes.
    pub need: u64,
    /// What there is.
    pub free: Free,
}

/// What the system is not asked about: it is a small part of [`SMALL`], and asking takes longer than to read a
/// file of this kind.
const UNASKED: u64 = 1 << 20;

/// Whether this number of bytes more can be had; where the system does not tell, they can. Up to a mebibyte is
/// not asked about: whoever takes that often has to add it up.
pub fn fits(need: u64, what: impl FnOnce() -> String) -> Result<(), TooLarge> {
    if need <= UNASKED {
        return Ok(());
    }
    match free() {
        Some(free) if need > free.bytes => Err(TooLarge { what: what(), need, free }),
        _ => Ok(()),
    }
}

/// What this process may still take: the least that the machine, its control groups and the limits
/// of the process leave. `None` where the system does not tell, which is anywhere but on Linux.
pub fn free() -> Option<Free> {
    let text = |path: &str| fs::read_to_string(path).ok();
    let (limits, status) = (text("/proc/self/limits"), text("/proc/self/status"));
    let one_place = std::env::var(ONE_PLACE.0).is_ok_and(|value| value == ONE_PLACE.1);
    let of_limits = limits
        .zip(status)
        .into_iter()
        .flat_map(|(limits, status)| own_limits(&limits, &status, one_place).into_iter().flatten());
    let machine = text("/proc/meminfo")
        .and_then(|text| Some(Free { bytes: kib(&text, "MemAvailable:")?, by: "of the machine" }));
    let groups = text("/proc/self/cgroup").map_or(Vec::new(), |text| control_groups(&text));
    of_limits.chain(machine).chain(groups).min_by_key(|free| free.bytes)
}

/// The memory that the machine has, in bytes; `None` where the system does not tell, which is anywhere
/// but on Linux.
pub fn machine() -> Option<u64> {
    kib(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")
}

/// What tells the C library to have one place for all threads, before a program begins. Without it
/// each thread sets aside address space of its own.
pub const ONE_PLACE: (&str, &str) = ("MALLOC_ARENA_MAX", "1");

/// The limit of `ulimit -v`, in bytes; `None` without one.
pub fn address_space() -> Option<u64> {
    soft(&fs::read_to_string("/proc/self/limits").ok()?, "Max address space")
}

fn soft(limits: &str, name: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// What a thread takes of the address space beside what it was made for: its stack, and what the C
/// library sets aside for it.
const STACK: u64 = 4 << 20;
const ASIDE: u64 = 64 << 20;
/// What is asked for in small pieces and not counted.
const SMALL: u64 = 32 << 20;

/// By `ulimit -v` and `ulimit -d`.
fn own_limits(limits: &str, status: &str, one_place: bool) -> [Option<Free>; 2] {
    let left = |name, used, by| {
        let bytes = soft(limits, name)?.saturating_sub(kib(status, used)?);
        Some(Free { bytes, by })
    };
    let space = left("Max address space", "VmSize:", "under `ulimit -v`");
    let data = left("Max data size", "VmData:", "under `ulimit -d`");
    // What threads that are still to come will set aside is gone for all else.
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let known = status.lines().find_map(|line| line.strip_prefix("Threads:"));
    let now: u64 = known.and_then(|n| n.trim().parse().ok()).unwrap_or(1);
    let each = STACK + if one_place { 0 } else { ASIDE };
    let coming = (2 * threads + 2).saturating_sub(now) * each;
    [space, data].map(|free| {
        free.map(|free| {
            let bytes = free.bytes.saturating_sub(SMALL);
            // They do without it where it cannot be had, so that it counts for a half at most.
            Free { bytes: bytes - coming.min(bytes / 2), ..free }
        })
    })
}

/// The number of a line such as `MemAvailable:   12 kB`, in bytes.
fn kib(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
}

/// By the process's control group and all that it is in, of either version.
fn control_groups(own: &str) -> Vec<Free> {
    let mut all = Vec::new();
    for line in own.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(kind), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (root, limit, usage, inactive) = if kind.is_empty() {
            ("/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file ")
        } else if kind.split(',').any(|kind| kind == "memory") {
            let [limit, usage] = ["memory.limit_in_bytes", "memory.usage_in_bytes"];
            ("/sys/fs/cgroup/memory", limit, usage, "total_inactive_file ")
        } else {
            continue;
        };
        let own = Path::new(path.trim_start_matches('/'));
        for group in own.ancestors() {
            let folder = Path::new(root).join(group);
            let number = |name: &str| -> Option<u64> {
                fs::read_to_string(folder.join(name)).ok()?.trim().parse().ok()
            };
            let (Some(limit), Some(used)) = (number(limit), number(usage)) else { continue };
            // Files that were read are forgotten when their room is wanted.
            let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
            let line = stat.lines().find_map(|line| line.strip_prefix(inactive));
            let cached: u64 = line.and_then(|n| n.trim().parse().ok()).unwrap_or(0);
            let bytes = limit.saturating_sub(used.saturating_sub(cached));
            all.push(Free { bytes, by: "of the control group" });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_told_in_their_own_units() {
        let told = |n: u64| Bytes(n).to_string();
        assert_eq!(told(1023), "1023 bytes");
        assert_eq!(told(4 << 30), "4 GiB");
        assert_eq!(told(3 << 29), "1.5 GiB");
        assert_eq!(told((1 << 20) + 1), "1.0 MiB");
    }

    #[test]
    fn what_is_left_under_a_limit_is_what_is_not_yet_taken() {
        let limits = "Limit  Soft Limit  Hard Limit  Units\n\
                      Max data size             unlimited            unlimited            bytes\n\
                      Max address space         4294967296           unlimited            bytes\n";
        let status = "VmSize:\t 1048576 kB\nVmData:\t 1024 kB\nThreads:\t40000\n";
        let [space, data] = own_limits(limits, status, false);
        assert_eq!(data, None);
        assert_eq!(space.unwrap().bytes, (3 << 30) - SMALL);
        // Threads that are to come take of it, but never all.
        let [space, _] = own_limits(limits, &status.replace("40000", "1"), false);
        let bytes = space.unwrap().bytes;
        let left = (3 << 30) - SMALL;
        assert!((left / 2..left).contains(&bytes), "{bytes}");
        let [alone, _] = own_limits(limits, &status.replace("40000", "1"), true);
        assert!(alone.unwrap().bytes > bytes, "one place for all leaves more");
        let [space, _] = own_limits(&limits.replace("4294967296", "1024"), status, true);
        assert_eq!(space.unwrap().bytes, 0);
    }

    /// Every number of [`table`] is in the README, where people look.
    #[test]
    fn the_readme_states_every_limit() {
        let readme = include_str!("../README.md");
        for (what, how_much) in table() {
            let row = format!("| {what} | {how_much} |");
            assert!(readme.contains(&row), "the README lacks: {row}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_has_some_memory_and_not_all_of_it() {
        let free = free().unwrap();
        assert!(free.bytes > 1 << 20 && free.bytes < 1 << 50, "{free:?}");
        assert_eq!(fits(1 << 20, || unreachable!()), Ok(()));
        let told = fits(u64::MAX, || "this".to_owned()).unwrap_err().to_string();
        assert!(told.starts_with("this needs about 17179869184 GiB of memory, and "), "{told}");
    }
}
