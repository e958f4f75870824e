#!/bin/sh
# Opens the real window on a virtual display and looks at the picture that it takes of itself; then
# asks for a window where there is no display. Needs xvfb, imagemagick and a software OpenGL.
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
    timeout 120 xvfb-run -a -s "-screen 0 1280x720x24 -noreset" \
        "$burnish" --size 1280x720 "--$theme" --exit-after 4 --screenshot "$shot" ||
        fail "the window in $theme colours ended with $?"
    # A PNG holds its width and height from byte 16 on.
    width=$(($(byte "$shot" 18) * 256 + $(byte "$shot" 19)))
    height=$(($(byte "$shot" 22) * 256 + $(byte "$shot" 23)))
    [ "$width"x"$height" = 1280x720 ] || fail "the picture is ${width}x$height, not 1280x720"
    # A window that drew nothing is flat; one that shows a render is neither black nor white.
    stats=$(identify -format '%[fx:mean] %[fx:standard_deviation]' "$shot")
    echo "window-smoke: $theme: mean and standard deviation $stats"
    echo "$stats" | awk '{ exit !($1 > 0.1 && $1 < 0.9 && $2 > 0.08 && $2 < 0.4) }' ||
        fail "mean and standard deviation of the window are $stats"
done
cmp -s "$folder/dark.png" "$folder/light.png" && fail "dark and light look the same"

status=0
env -u DISPLAY -u WAYLAND_DISPLAY -u WAYLAND_SOCKET "$burnish" 2>"$folder/said" || status=$?
[ "$status" -eq 1 ] || fail "without a display the exit code is $status, not 1"
[ "$(wc -l <"$folder/said")" -eq 1 ] || fail "without a display there is more than one line"
grep -q "burnish render" "$folder/said" || fail "the line without a display names no way out"
echo "window-smoke: passed"
