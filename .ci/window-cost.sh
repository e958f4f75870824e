#!/bin/sh
# What the window costs, measured on the real one on a virtual display, with a picture of 1600x1200:
# the slowest frame's own work while keys are held, that of a flip between two kept models, the share of processor time that does not go to
# the workers once the window is left alone, and what it takes while it rests.
#
#   .ci/window-cost.sh [BURNISH]
#
# SIZE="640 480" is another size. Needs Linux, xvfb, xdotool and a software OpenGL, whose work is
# counted as the window's.
set -eu

if [ "${1:-}" != --inside ]; then
    burnish=$(realpath "${1:-target/release/burnish}")
    exec xvfb-run -a -s "-screen 0 1280x720x24 -noreset" "$0" --inside "$burnish" "$(realpath "$0")"
fi
burnish=$2
assets=$(dirname "$3")/../assets/scenes
desk=$(mktemp -d)
pid=
trap '[ -z "$pid" ] || kill "$pid" 2>/dev/null || :; rm -rf "$desk"' EXIT
export HOME="$desk" XDG_CONFIG_HOME="$desk/config" XDG_RUNTIME_DIR="$desk"
cp "$assets"/*.ply "$desk"
sed "s/^screen.*/screen ${SIZE:-1600 1200}/" "$assets/default.scn" >"$desk/large.scn"
cd "$desk"
# The picture is as large as the scene says, not as the window has room for.
mkdir -p config/burnish
echo '{"follow": false}' >config/burnish/window.json

# Milliseconds of processor time so far, of the workers and of all other threads.
spent() {
    for task in /proc/"$pid"/task/*; do
        printf '%s %s\n' "$(cut -d' ' -f1 "$task/schedstat")" "$(cat "$task/comm")"
    done | awk '/burnish worker/ { w += $1; next } { o += $1 }
        END { printf "%.1f %.1f\n", w / 1e6, o / 1e6 }'
}

# over SECONDS WHAT LIMIT: the others' share of all that was spent, and of one processor's time.
over() {
    before=$(spent)
    sleep "$1"
    echo "$before $(spent)" | awk -v s="$1" -v what="$2" '{
        w = $3 - $1; o = $4 - $2
        printf "window-cost: %s: workers %.0f ms/s, the rest %.1f ms/s", what, w / s, o / s
        if (w > 0) printf ", %.1f %% of all", 100 * o / (w + o)
        print "" }'
}

begin() {
    "$burnish" large.scn -v --size 1280x720 --dark 2>said &
    pid=$!
    tries=0
    until window=$(xdotool search --onlyvisible --name "large.scn - burnish" 2>/dev/null | head -n 1) &&
        [ -n "$window" ]; do
        tries=$((tries + 1))
        [ "$tries" -lt 300 ] || { echo "window-cost: no window" >&2; exit 1; }
        sleep 0.2
    done
    xdotool windowfocus --sync "$window"
}

# end WHAT: how long the window takes to close, and what it says of its work.
end() {
    closed=$(date +%s%N)
    xdotool key ctrl+q
    wait "$pid"
    pid=
    echo "window-cost: $1: closed in $((($(date +%s%N) - closed) / 1000000)) ms"
    sed "s/^/window-cost: $1: /" said
}

begin
sleep 2
# As if keys were held and a slider dragged.
for keys in "e shift+e" "bracketright bracketleft" "1 2 3"; do
    for i in 1 2 3 4 5 6; do
        # shellcheck disable=SC2086
        xdotool key --delay 40 $keys $keys $keys
    done
done
xdotool mousemove 1050 100 mousedown 1
for x in 1060 1080 1100 1120 1140 1160 1180 1160 1140 1120 1100; do
    xdotool mousemove "$x" 100
    sleep 0.05
done
xdotool mouseup 1 mousemove 400 300
sleep 4
over 10 "left alone"
xdotool key space
sleep 6
over 5 "paused"
end "keys and a slider"

# Two kept models, one after the other and back: nearly all frames of this session are flips.
begin
sleep 12
xdotool key 1
sleep 12
for i in $(seq 60); do
    xdotool key 3
    sleep 0.15
    xdotool key 1
    sleep 0.15
done
end "flips"
