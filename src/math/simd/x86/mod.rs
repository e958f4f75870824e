//! The instruction sets of x86-64.
#![allow(unsafe_code)]

mod avx2;
mod avx512;
mod sse2;

use super::pair::SimdPair;
use super::{Isa, Kernel};
use avx2::Avx2;
use avx512::Avx512;
use sse2::Sse2;

#[cfg(not(target_feature = "sse2"))]
compile_error!("the lanes of x86-64 lean on SSE2, which this build has switched off");

/// Whether this machine has a set.
pub(super) fn has(isa: Isa) -> bool {
    match isa {
        Isa::Portable => true,
        Isa::Avx2 => has_avx2(),
        Isa::Avx512 => has_avx512(),
        Isa::Avx512Gfni => has_avx512() && has_gfni(),
        Isa::Neon => false,
    }
}

/// Runs a kernel on a set, or on the next plainer one that the machine has.
#[inline(always)]
pub(super) fn run<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    match isa {
        Isa::Avx2 => run_avx2(kernel),
        Isa::Avx512 => run_avx512(kernel),
        Isa::Avx512Gfni => run_avx512_gfni(kernel),
        Isa::Portable | Isa::Neon => run_portably(kernel),
    }
}

/// Of its own, so that each kernel is compiled once for all its callers.
#[inline(never)]
fn run_portably<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<SimdPair<Sse2>, Sse2>()
}

// The standard library remembers what it found: a load and a branch each.
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512vl")
}

fn has_gfni() -> bool {
    is_x86_feature_detected!("gfni")
}

/// Runs a kernel compiled for AVX2 and FMA; portable code where the machine lacks them.
#[inline(always)]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,fma")]
    fn featured<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2, Avx2>()
    }
    if has_avx2() {
        // SAFETY: the machine was just found to have these.
        unsafe { featured(kernel) }
    } else {
        run_portably(kernel)
    }
}

/// The same for AVX-512. What is eight wide stays so, in AVX2 registers.
#[inline(always)]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512bw,avx512vl")]
    fn featured<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2, Avx512<false>>()
    }
    if has_avx512() {
        // SAFETY: the machine was just found to have these.
        unsafe { featured(kernel) }
    } else {
        run_avx2(kernel)
    }
}

/// The same for AVX-512 with GFNI.
#[inline(always)]
fn run_avx512_gfni<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512bw,avx512vl,gfni")]
    fn featured<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2, Avx512<true>>()
    }
    if has_avx512() && has_gfni() {
        // SAFETY: the machine was just found to have these.
        unsafe { featured(kernel) }
    } else {
        run_avx512(kernel)
    }
}
