//! Large arrays in large pages.
//!
//! Rays go anywhere: in a mesh of millions nearly every step is to another page of memory, and of
//! pages of 4 KiB the processor knows the places of a few MiB only. So arrays that are larger than
//! that are mapped by themselves, and the system is asked for its large pages (2 MiB on x86-64)
//! there, on Linux alone: other systems give them, if at all, to programs with special rights. Where it
//! has none, or does not map, nothing but the speed differs.

use bytemuck::Pod;
use memmap2::MmapMut;
use std::fmt;
use std::ops::{Deref, DerefMut};

/// An array of fewer bytes is better off with all others.
const LEAST: usize = 4 << 20;

/// A fixed number of records.
pub(super) enum HugePages<T> {
    Listed(Vec<T>),
    /// Of these records' bytes exactly.
    Mapped(MmapMut),
}

impl<T: Pod> HugePages<T> {
    /// `len` records, all of zeros.
    pub(super) fn zeroed(len: usize) -> HugePages<T> {
        let bytes = len.saturating_mul(size_of::<T>());
        let map = if bytes < LEAST { None } else { MmapMut::map_anon(bytes).ok() };
        match map {
            Some(map) => {
                #[cfg(target_os = "linux")]
                // Whether it is heard is the system's affair.
                let _ = map.advise(memmap2::Advice::HugePage);
                HugePages::Mapped(map)
            }
            None => HugePages::Listed(vec![T::zeroed(); len]),
        }
    }
}

impl<T> Default for HugePages<T> {
    fn default() -> HugePages<T> {
        HugePages::Listed(Vec::new())
    }
}

/// Found anew at each use: loops look once, before they begin.
impl<T: Pod> Deref for HugePages<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        match self {
            HugePages::Listed(records) => records,
            HugePages::Mapped(map) => bytemuck::cast_slice(map),
        }
    }
}

impl<T: Pod> DerefMut for HugePages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match self {
            HugePages::Listed(records) => records,
            HugePages::Mapped(map) => bytemuck::cast_slice_mut(map),
        }
    }
}

impl<T: Pod> fmt::Debug for HugePages<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} records", self.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_what_was_put_there_however_many() {
        for len in [0, 1, 1000, LEAST / 32 - 1, LEAST / 32, LEAST / 32 + 1, 1_000_003] {
            let mut huge_pages = HugePages::<[u64; 4]>::zeroed(len);
            assert_eq!(matches!(huge_pages, HugePages::Mapped(_)), len * 32 >= LEAST, "{len}");
            assert!(
                huge_pages.len() == len && huge_pages.iter().all(|record| *record == [0; 4]),
                "{len}"
            );
            for (i, record) in huge_pages.iter_mut().enumerate() {
                record[i % 4] = i as u64;
            }
            for (i, record) in huge_pages.iter().enumerate() {
                assert!(record[i % 4] == i as u64 && record[(i + 1) % 4] == 0, "{i} of {len}");
            }
        }
    }
}
