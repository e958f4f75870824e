//! The instruction sets of AArch64: NEON, which all of them have. So it is chosen when compiled, and
//! all that is left to choose is whether sums are fused.

mod neon;

use super::pair::SimdPair;
use super::{Isa, Kernel};
use neon::Neon;

#[cfg(not(target_feature = "neon"))]
compile_error!("the lanes of AArch64 lean on NEON, which this build has switched off");

/// Whether this machine has a set.
pub(super) fn has(isa: Isa) -> bool {
    matches!(isa, Isa::Portable | Isa::Neon)
}

/// Runs a kernel on a set, or on the portable one where there is none of the name.
#[inline(always)]
pub(super) fn run<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    match isa {
        Isa::Neon => run_fused(kernel),
        _ => run_portably(kernel),
    }
}

/// Of its own, so that each kernel is compiled once for all its callers.
#[inline(never)]
fn run_fused<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<SimdPair<Neon<true>>, Neon<true>>()
}

/// The same, each sum rounded after its product, as portable code does.
#[inline(never)]
fn run_portably<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<SimdPair<Neon<false>>, Neon<false>>()
}
