#!/bin/sh
# Makes the pictures of screenshots/ but the plot. What they are: README.md there. Those of the window
# need xvfb, xdotool, imagemagick and a software OpenGL; WINDOW=no leaves them out.
#
#   .ci/pictures.sh [BURNISH]
#
# DIVIDE=64 makes all of them with so many times fewer passes, to try; FOLDER=... writes elsewhere.
set -eu
cd "$(dirname "$0")/.."

burnish=${1:-target/release/burnish}
folder=${FOLDER:-screenshots}
divide=${DIVIDE:-1}
mkdir -p "$folder"

# render PASSES ARGUMENTS...
# Every path for itself: what so many passes show is what is to be seen, and thousands of them of paths
# that share would take hours.
render() {
    passes=$(($1 / divide))
    shift
    "$burnish" render --no-reuse --passes $((passes > 0 ? passes : 1)) "$@"
}

# What the seed showed: the default scene, each model from one pass to many.
for n in 1 8 64 512; do
    render $n --model all --size 400x300 -o "$folder/{name}_{model}_$n.png"
done
render 4096 --model beckmann --size 400x300 -o "$folder/{name}_{model}_4096.png"

# Large.
render 512 --model ggx --size 1600x1200 -o "$folder/{name}_{model}_1600x1200.png"

# Every roughness with every model.
render 512 gallery --model all --size 640x360 -o "$folder/{name}_{model}.png"

# The window itself, and a sheet of what it shows while it is driven.
if [ "${WINDOW:-yes}" = yes ]; then
    .ci/window-pictures.sh "$burnish" "$folder"
    tour=$(mktemp -d)
    trap 'rm -rf "$tour"' EXIT
    .ci/window-tour.sh "$burnish" "$tour"
    montage -label "%t" "$tour"/*.png -tile 4x -geometry 400x225+4+4 -depth 8 \
        "png24:$folder/window_tour.png"
fi

find "$folder" -name '*.png' -exec cat {} + | wc -c |
    awk '{ printf "%.1f MB of PNG files, of 12\n", $1 / 1e6; exit !($1 < 12e6) }'
