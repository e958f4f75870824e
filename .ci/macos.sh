#!/usr/bin/env bash
# The library and the command line checked by the compiler for macOS on ARM, as far as that goes without a Mac:
# nothing is linked, nothing is run. Needs Debian's rustc-web and rust-web-src; no part of `.ci/run`.
set -euo pipefail
cd "$(dirname "$0")/.."
RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 cargo check -Z build-std=std,panic_unwind --no-default-features \
    --target aarch64-apple-darwin --target-dir target/macos --config 'profile.dev.package."*".opt-level=0'
