//! Processors without lanes of their own: plain Rust.

use super::{F32x8, Isa, Kernel};

/// Whether this machine has a set.
pub(super) fn has(isa: Isa) -> bool {
    isa == Isa::Portable
}

/// Runs a kernel. Of its own, so that each is compiled once for all its callers.
#[inline(never)]
pub(super) fn run<K: Kernel>(_: Isa, kernel: K) -> K::Output {
    kernel.run::<F32x8, f32>()
}
