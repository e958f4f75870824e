#!/usr/bin/env bash
# The library built for AArch64 Linux, and run by an emulator of its user mode: the tests of the lanes and some
# of each room above them, and pictures of the shipped scenes through the engine, which must have the bits of
# those made on this machine, with fused sums and without.
#
#   .ci/aarch64.sh             skips, and says why, where a package is missing
#   .ci/aarch64.sh --install   installs the packages first (Debian, as root)
#   .ci/aarch64.sh --all       every unit test, built to run fast, without a limit: about an hour
#
# LIMIT, in seconds, is what all of it may take, 240 if it is not set. What is not done by then is skipped too:
# a machine may be slow, and only what is wrong has failed.
set -euo pipefail
cd "$(dirname "$0")/.."

limit=${LIMIT:-240}
target=aarch64-unknown-linux-gnu
# Debian's compiler for browsers: recent, and its standard library comes for other processors as well.
packages=(rustc-web libstd-rust-web-dev:arm64 gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user)
# Emulated, tests of many rays or passes take minutes each.
tests=(math:: brdf:: picture:: film:: geometry::pages)

# Seconds that are left; `timeout` takes 0 for no limit.
left() {
    [ "$limit" = 0 ] && echo 0 && return
    local rest=$((limit - SECONDS))
    echo $((rest > 1 ? rest : 1))
}
skip() {
    printf 'AArch64 skipped: %s\n' "$*"
    exit 0
}

if [ "${1:-}" = --install ] && ! dpkg -s "${packages[@]}" >/dev/null 2>&1; then
    dpkg --add-architecture arm64 || skip "packages cannot be installed: ${packages[*]}"
    timeout "$(left)" apt-get update -qq || true
    DEBIAN_FRONTEND=noninteractive timeout "$(left)" apt-get install -y -qq --no-install-recommends "${packages[@]}" \
        >/dev/null || skip "packages cannot be installed: ${packages[*]}"
fi

[ "$(uname -m)" = x86_64 ] || skip "this machine is no x86-64"
compiler=/usr/bin/rustc
[ -x "$compiler" ] || skip "no $compiler (rustc-web)"
has=$("$compiler" --version | cut -d ' ' -f 2 | cut -d . -f 1,2)
needs=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
[ "$(printf '%s\n' "$needs" "$has" | sort -V | head -n 1)" = "$needs" ] ||
    skip "$compiler is of $has, older than $needs"
ls "$("$compiler" --print sysroot)/lib/rustlib/$target/lib"/libstd-*.rlib >/dev/null 2>&1 ||
    skip "no standard library for $target (libstd-rust-web-dev:arm64)"
command -v aarch64-linux-gnu-gcc >/dev/null || skip "no linker (gcc-aarch64-linux-gnu)"
command -v qemu-aarch64 >/dev/null || skip "no emulator (qemu-user)"
[ -e /lib/ld-linux-aarch64.so.1 ] || skip "no C library to run with (libc6:arm64)"

# Quick to build rather than to run: what others wrote is not optimized, but for what makes the tree. Without
# the window's tests, and what they alone need.
build() {
    # The ones that Cargo.toml wants fast.
    local named quick
    mapfile -t named < <(sed -n 's/^\([a-z0-9_-]*\) = { opt-level = 3 }$/\1/p' Cargo.toml)
    quick=("${named[@]/#/--config=profile.release.package.}")
    quick=("${quick[@]/%/.opt-level=0}")
    quick+=(--config 'profile.release.package."*".opt-level=0')
    quick+=(--config=profile.release.package.{burnish,obvhs}.opt-level=1)
    # Who runs every test waits longer for those than for this.
    [ "$limit" != 0 ] || quick=()
    RUSTC=$compiler CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc \
        CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUSTFLAGS="--cfg headless" \
        CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 \
        timeout "$(left)" cargo test --release --no-default-features --lib --no-run --target "$target" \
        "${quick[@]}" --config profile.release.package.burnish.codegen-units=16 \
        --target-dir target/aarch64 --message-format json-render-diagnostics
}
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
mkdir "$made/here" "$made/there"

[ "${1:-}" = --all ] && limit=0
build >"$made/messages" || {
    [ $? = 124 ] && skip "not built within $limit s"
    exit 1
}
binary=$(sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' "$made/messages" | tail -n 1)
file=$(od -An -tx2 -j 18 -N 2 "$binary" | tr -d ' ')
[ "$file" = 00b7 ] || { echo "$binary is not for AArch64"; exit 1; }

[ "${1:-}" = --all ] && tests=()
BURNISH_PICTURES=$made/there timeout "$(left)" qemu-aarch64 "$binary" "${tests[@]}" || {
    [ $? = 124 ] && skip "built, but its tests were not done within $limit s"
    exit 1
}
BURNISH_PICTURES=$made/here cargo test --release --lib -- every_fused_set_makes_one_picture

count=0
for picture in "$made"/here/*.f32; do
    cmp "$picture" "$made/there/${picture##*/}"
    count=$((count + 1))
done
[ "$count" -gt 0 ]
echo "$count pictures made for AArch64 have the bits of those of x86-64."
