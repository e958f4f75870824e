#!/bin/sh
# Opens the real window on a virtual display and looks at the picture that it takes of itself; then
# asks for a window where there is no display. Needs xvfb and a software OpenGL.
#
#   .ci/window-smoke.sh [BURNISH]
set -eu

burnish=${1:-target/release/burnish}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export XDG_RUNTIME_DIR="$folder"

fail() {
    echo "window-smoke: $1" >&2
    exit 1
}

# One byte of a file, as a number.
byte() {
    od -An -tu1 -j"$2" -N1 "$1" | tr -d ' '
}

for theme in dark light; do
    shot="$folder/$theme.png"
    timeout 120 xvfb-run -a -s "-screen 0 1280x720x24" \
        "$burnish" --size 1280x720 "--$theme" --exit-after 4 --screenshot "$shot" ||
        fail "the window in $theme colours ended with $?"
    # A PNG holds its width and height from byte 16 on.
    width=$(($(byte "$shot" 18) * 256 + $(byte "$shot" 19)))
    height=$(($(byte "$shot" 22) * 256 + $(byte "$shot" 23)))
    [ "$width"x"$height" = 1280x720 ] || fail "the picture is ${width}x$height, not 1280x720"
    # Controls alone compress to some 20 kB; a path-traced picture does not.
    [ "$(wc -c <"$shot")" -gt 150000 ] || fail "the window shows no render"
done
cmp -s "$folder/dark.png" "$folder/light.png" && fail "dark and light look the same"

status=0
env -u DISPLAY -u WAYLAND_DISPLAY -u WAYLAND_SOCKET "$burnish" 2>"$folder/said" || status=$?
[ "$status" -eq 1 ] || fail "without a display the exit code is $status, not 1"
[ "$(wc -l <"$folder/said")" -eq 1 ] || fail "without a display there is more than one line"
grep -q "burnish render" "$folder/said" || fail "the line without a display names no way out"
echo "window-smoke: passed"
