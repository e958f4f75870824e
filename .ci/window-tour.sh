#!/bin/sh
# Drives the real window on a virtual display, as a person would: opens a scene, switches the models,
# compares them, changes the roughness, asks a pixel, opens the lobes, makes a contact sheet, picks a
# material, saves, undoes, closes and comes back. What each step did is
# read from the files that the window writes; a screenshot of each is kept.
#
#   .ci/window-tour.sh [BURNISH [FOLDER]]
#
# SIZE=900x600 and THEME=light are another size and other colours.
#
# Needs xvfb, xdotool, imagemagick and a software OpenGL.
set -eu

if [ "${1:-}" != --inside ]; then
    burnish=$(realpath "${1:-target/release/burnish}")
    shots=${2:-target/window-tour}
    mkdir -p "$shots"
    shots=$(realpath "$shots")
    # A server that resets when its last window closes turns away whoever comes in that moment.
    exec xvfb-run -a -s "-screen 0 ${SIZE:-1280x720}x24 -noreset" "$0" --inside "$burnish" "$shots"
fi
burnish=$2
shots=$3
size=${SIZE:-1280x720}
desk=$(mktemp -d)
pid=
trap '[ -z "$pid" ] || kill "$pid" 2>/dev/null || :; rm -rf "$desk"' EXIT
# Nothing of the user's own is read or written.
export HOME="$desk" XDG_CONFIG_HOME="$desk/config" XDG_RUNTIME_DIR="$desk"
cd "$desk"

fail() {
    echo "window-tour: $1" >&2
    exit 1
}

# Tries a command for a minute.
until_so() {
    what=$1
    shift
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ "$tries" -lt 100 ] || fail "never $what$(echo; cat said 2>&1)"
        sleep 0.2
    done
}

key() {
    xdotool key --clearmodifiers --delay 60 "$@"
}

step=0
shot() {
    step=$((step + 1))
    name=$(printf "%02d-%s.png" "$step" "$1")
    # Time for the last pixels; nothing depends on it.
    sleep 1
    import -window root "$shots/$name"
    echo "window-tour: $name"
}

titled() {
    window=$(xdotool search --onlyvisible --name " - burnish" 2>/dev/null | head -n 1) &&
        [ -n "$window" ] && case "$(xdotool getwindowname "$window")" in
            # Before the name, how far the picture is.
            "$1 - burnish" | *" % - $1 - burnish") ;;
            *) false ;;
        esac
}

# Starts the window and gives it the keyboard.
begin() {
    "$burnish" "$@" &
    pid=$!
}

focus() {
    kill -0 "$pid" || fail "there is no window"
    until_so "titled $1" titled "$1"
    xdotool windowfocus --sync "$window"
}

end() {
    key ctrl+q
    wait "$pid" || fail "the window ended with $?"
    pid=
}

# Takes snapshots until one says of itself what is expected: the newest picture may be of before.
snapshot_says() {
    before=$(find . -name '*.png' | wc -l)
    key s
    waited=0
    while [ "$(find . -name '*.png' | wc -l)" -le "$before" ]; do
        waited=$((waited + 1))
        [ "$waited" -lt 100 ] || return 1
        sleep 0.1
    done
    sleep 0.3
    newest=$(ls -t ./*.png | head -n 1)
    "$burnish" info "$newest" >said 2>&1 && grep -q -- "$1" said
}

cat >tour.scn <<'SCENE'
screen 320 240
environment 0.3 0.35 0.4
camera 0 -6 0 0.35 x 90
brdf 0.6 0.1 0.1 0.2 0.2 0.2 100
sphere -1.1 0 0 1
brdf 0.1 0.1 0.6 0.2 0.2 0.2 100
sphere 1.1 0 0 1
light 20 20 20
sphere 2 -4 4 0.7
SCENE

begin --size "$size" "--${THEME:-dark}"
focus "Brass knot"
shot start

key ctrl+o
sleep 0.5
xdotool type --delay 30 "$desk/tour.scn"
key Return
focus tour.scn
shot opened

for model in 1:phong 2:beckmann 3:ggx; do
    key "${model%%:*}"
    until_so "${model##*:}" snapshot_says "--model ${model##*:}"
    shot "model-${model##*:}"
done

# The red ball is left of the middle of the picture, whose room the panel and the margins leave.
left=$((16 + (${size%%x*} - 335) * 31 / 100))
middle=$((16 + (${size##*x} - 60) / 2))
key c
sleep 3
shot compared
key c
xdotool mousemove --window "$window" "$left" "$middle" click 1
key p
sleep 3
shot pixel
key p l
sleep 2
shot lobes
key l Escape Escape

# Where the noise is, where the samples went, and how the error fell; snapshots are of the picture.
key m
shot noise-map
key m
shot sample-map
key m
key g
shot errors
key g

# Four presses double alpha: a_p from 100 to 102 / 4 - 2.
key bracketright bracketright bracketright bracketright
until_so "rougher" snapshot_says "a_p 23.5"
shot rougher
key ctrl+z
until_so "as rough as before" snapshot_says "the scene's"
grep -q "edited" said && fail "undo left the roughness: $(cat said)"
shot undone

# The red ball is left of the middle of the picture.
xdotool mousemove --window "$window" "$left" "$middle" click 1
sleep 0.5
shot picked
key bracketleft bracketleft bracketleft bracketleft
shot picked-smoother
key ctrl+shift+s
until_so "saved" test -s tour-edited.scn
# 100 and alpha / 2 is 406; the blue ball's line and all others are as they were.
diff tour.scn tour-edited.scn >changes && fail "the saved scene has no edit"
[ "$(grep -c '^>' changes)" -eq 1 ] || fail "more was changed than one line: $(cat changes)"
grep -q '^> brdf 0.6 0.1 0.1 0.2 0.2 0.2 40[56]' changes || fail "another line: $(cat changes)"
shot scene-saved
key ctrl+z
sleep 0.5
rm tour-edited.scn
key ctrl+shift+s
until_so "saved again" test -s tour-edited.scn
cmp -s tour.scn tour-edited.scn || fail "undo left an edit: $(diff tour.scn tour-edited.scn)"
shot undone-again

# A contact sheet is begun, and stopped: then it leaves no file.
key shift+s
key Escape
sleep 0.5
[ -z "$(find . -name '*sheet*')" ] || fail "a stopped sheet was written"
shot sheet-stopped

# The file is written anew by somebody else.
sed 's/^sphere 2 -4 4.*/sphere 2 -4 4 0.9/' tour.scn >new && mv new tour.scn
until_so "read again" snapshot_says "$(sha256sum tour.scn | cut -c1-64)"
shot file-changed

# What has no dialog to show says so.
key ctrl+shift+o
shot no-dialog
key Escape
key e e
shot brighter

# A contact sheet is made, which takes a while.
key shift+s
tries=0
until [ -n "$(find . -name '*sheet*.exr')" ]; do
    tries=$((tries + 1))
    [ "$tries" -lt 600 ] || fail "no contact sheet after ten minutes"
    sleep 1
done
shot sheet-made
cp ./*sheet*.png "$shots/$(printf %02d "$((step + 1))")-the-sheet.png"
end
grep -q "tour.scn" config/burnish/window.json || fail "the scene is not remembered"
grep -q '"follow": true' config/burnish/window.json || fail "that the picture follows is not remembered"

# The screen on which it was is gone.
grep -q '"size": \[' config/burnish/window.json || fail "the size is not remembered"
tr -d '\n' <config/burnish/window.json |
    sed 's/"position": *\(null\|\[[^]]*\]\)/"position": [5000, 5000]/' >new
mv new config/burnish/window.json
begin
focus "Brass knot"
eval "$(xdotool getwindowgeometry --shell "$window")"
[ "$X" -lt "${size%%x*}" ] && [ "$Y" -lt "${size##*x}" ] || fail "the window is out of sight, at $X, $Y"
[ "${WIDTH}x$HEIGHT" = "$size" ] || fail "the window is ${WIDTH}x$HEIGHT, not as it was"
until_so "as bright as on the first day" snapshot_says "--exposure 0 "
shot again
end
begin --reset-settings gallery
focus Gallery
end
grep -q "tour.scn" config/burnish/window.json 2>/dev/null && fail "the scene is still remembered"
echo "window-tour: passed"
