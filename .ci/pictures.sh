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
render() {
    passes=$(($1 / divide))
    shift
    "$burnish" render --passes $((passes > 0 ? passes : 1)) "$@"
}

# As the seed's report did: the default scene, each model from one pass to many, every path for itself, so that
# what so many passes show is seen. 512 are shown as users get them, with paths that share.
for n in 1 8 64; do
    render $n --no-reuse --model all --size 400x300 -o "$folder/{name}_{model}_$n.png"
done
render 512 --model all --size 400x300 -o "$folder/{name}_{model}_512.png"

# The shell: very many passes, and large.
render 4096 shell --no-reuse --model beckmann --size 400x300 -o "$folder/{name}_{model}_4096.png"
render 512 shell --no-reuse --model ggx --size 1600x1200 -o "$folder/{name}_{model}_1600x1200.png"

# Every roughness with every model.
render 64 gallery --model all --size 640x360 -o "$folder/{name}_{model}.png"

# Every model with every roughness, each to the same error. Its radiance is left out: 6 MB.
sheet=$(mktemp -d)
trap 'rm -rf "$sheet"' EXIT
most=$((4096 / divide))
"$burnish" sheet -o "$sheet/sheet.png" --size 208x156 --error 5% \
    --max-passes $((most > 0 ? most : 1))
cp "$sheet/sheet.png" "$folder/"

# The window itself, and a sheet of what it shows while it is driven.
if [ "${WINDOW:-yes}" = yes ]; then
    .ci/window-pictures.sh "$burnish" "$folder"
    tour=$(mktemp -d)
    trap 'rm -rf "$sheet" "$tour"' EXIT
    .ci/window-tour.sh "$burnish" "$tour"
    montage -label "%t" "$tour"/*.png -tile 4x -geometry 400x225+4+4 -depth 8 \
        "png24:$folder/window_tour.png"
fi

find "$folder" -name '*.png' -exec cat {} + | wc -c |
    awk '{ printf "%.1f MB of PNG files, of 12\n", $1 / 1e6; exit !($1 < 12e6) }'
