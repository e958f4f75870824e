#!/usr/bin/env bash
# Miri runs what needs no unsafe code: the portable and scalar twins of the SIMD types, what is written over them, and
# parts of the library that are small enough for an interpreter. It finds undefined behaviour, also in the
# crates below, and overflow. Tests of millions of cases are left out by name: they would take days.
# Building takes some five minutes of one core the first time, the tests below two.
#
#     .ci/miri.sh            the tests named below
#     .ci/miri.sh film::     others
set -euo pipefail
cd "$(dirname "$0")/.."

if ! cargo +nightly miri --version >/dev/null 2>&1; then
    echo "Miri skipped: rustup toolchain install nightly --component miri,rust-src"
    exit 0
fi
tests=("$@")
[ $# -gt 0 ] || tests=(math::simd::tests::{lanes_are,packets_do,every_lane} math::frame film::state film::interval scene::read::text plain)
# The window's crates are not needed, and its tests would bring them.
export RUSTFLAGS="--cfg headless" MIRIFLAGS="-Zmiri-disable-isolation" CARGO_TARGET_DIR=target/miri
timeout "${LIMIT:-1800}" cargo +nightly miri test --lib --no-default-features -- "${tests[@]}"
