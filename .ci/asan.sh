#!/usr/bin/env bash
# The engine, its readers and the broken files of tests/fuzz under AddressSanitizer: it finds reads and writes
# beside what was allocated, and of what is freed, in the SIMD intrinsics, in mapped pages and in the crates
# below.
#
#     .ci/asan.sh                        the tests named below
#     .ci/asan.sh --test measure         others
set -euo pipefail
cd "$(dirname "$0")/.."

target=x86_64-unknown-linux-gnu
runtime="$(rustc +nightly --print sysroot 2>/dev/null || true)/lib/rustlib/$target/lib/librustc-nightly_rt.asan.a"
if [ "$(uname -sm)" != "Linux x86_64" ] || [ ! -e "$runtime" ]; then
    echo "AddressSanitizer skipped: it wants x86-64 Linux and rustup toolchain install nightly"
    exit 0
fi
tests=("$@")
[ $# -gt 0 ] || tests=(--lib --test trace --test geometry --test progressive --test readers --test fuzz)
# With --target, what is run while building is not instrumented. The window's crates are left out. Leaks are
# looked for too, and freed memory is kept from being used again for long.
export RUSTFLAGS="-Zsanitizer=address --cfg headless" CARGO_TARGET_DIR=target/asan
export ASAN_OPTIONS="detect_stack_use_after_return=1:${ASAN_OPTIONS:-}"
timeout "${LIMIT:-3600}" cargo +nightly test --release --target "$target" --no-default-features "${tests[@]}"
