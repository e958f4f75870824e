#!/usr/bin/env bash
# The command line built for Windows (x86-64, by the GNU linker) and run by Wine: shipped scenes rendered, told
# of, compared and proved, paths as Windows writes them, files with its line ends, a picture that stands in the
# place of another, Ctrl-C. Takes a quarter of an hour; no part of `.ci/run`.
#
#   .ci/windows.sh             says what is missing
#   .ci/windows.sh --install   installs the packages first (Debian, as root)
set -euo pipefail
cd "$(dirname "$0")/.."

target=x86_64-pc-windows-gnu
packages=(rustc-web rust-web-src gcc-mingw-w64-x86-64 wine wine64 bsdutils)
if [ "${1:-}" = --install ]; then
    apt-get update -qq || true
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
fi
compiler=/usr/bin/rustc
for tool in "$compiler" x86_64-w64-mingw32-gcc wine script; do
    command -v "$tool" >/dev/null || { echo "no $tool; it takes ${packages[*]}"; exit 1; }
done

# Debian has no standard library for this target, but its source: it is built along.
RUSTC=$compiler RUSTC_BOOTSTRAP=1 CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-gcc \
    CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 \
    cargo build -Z build-std=std,panic_unwind --release --no-default-features --target "$target" \
    --target-dir target/windows
program=$PWD/target/windows/$target/release/burnish.exe
project=$PWD

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export WINEDEBUG=-all WINEPREFIX=${WINEPREFIX:-$work/wine}
x86_64-w64-mingw32-gcc -O .ci/ctrl-c.c -o "$work/ctrl-c.exe"
x86_64-w64-mingw32-gcc -O -shared .ci/processprng.c -o "$work/bcryptprimitives.dll" -ladvapi32
cp "$program" "$work"
cd "$work"
burnish() { wine burnish.exe "$@"; }
step() { printf '\n== %s\n' "$*"; }
# The same folder, as Windows names it.
drive=$(winepath -w "$work" 2>/dev/null | tr -d '\r')

step "render shipped scenes, by every set of the machine"
small=(--size 64x48 --passes 16 -q)
for scene in default cornell plates lights; do
    burnish render "$scene" "${small[@]}" -o "$drive\\$scene.exr" -o "$scene.png"
    [ -s "$scene.exr" ] && [ -s "$scene.png" ]
done
for isa in portable avx2; do
    burnish render cornell "${small[@]}" --isa $isa -o "$isa.exr" || echo "no $isa here"
done

step "info and compare"
burnish info 'cornell.exr'
burnish compare "$drive\\cornell.exr" avx2.exr

step "a scene by a path with backslashes, with a drive, with CRLF"
mkdir -p rooms/models
cp "$project"/assets/scenes/cornell-*.ply rooms/models/
sed -e 's/cornell-\([a-z]*\.ply\)/models\\cornell-\1/' -e 's/$/\r/' "$project/assets/scenes/cornell.scn" >rooms/box.scn
grep -c $'\r' rooms/box.scn
burnish render 'rooms\box.scn' "${small[@]}" -o 'rooms\box.exr'
burnish render "$drive\\rooms\\box.scn" "${small[@]}" -o "$drive\\rooms\\again.exr"
burnish compare 'rooms\box.exr' 'rooms/again.exr' | sed -n 1,2p
burnish compare 'rooms\box.exr' cornell.exr | sed -n 1,2p

step "a picture in the place of another, and no file beside it"
before=$(stat -c %i rooms/box.exr)
burnish render cornell "${small[@]}" --seed 2 -o 'rooms\box.exr'
[ "$(stat -c %i rooms/box.exr)" != "$before" ]
ls -A rooms
[ -z "$(find . -path ./wine -prune -o -name '.burnish-*' -print)" ]

step "Ctrl-C ends a render early and still writes it"
script -qec "wine ctrl-c.exe 4000 burnish.exe render cornell --passes 1000000 -o early.exr" /dev/null
burnish info early.exr | grep -i passes

step "the proofs of a model"
burnish check --model ggx --alpha 0.1
