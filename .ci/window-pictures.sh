#!/bin/sh
# Takes the window's own pictures for screenshots/, under a virtual display: the built-in scene after
# three quarters of a minute, and what the tour shows of comparing, asking a pixel, lobes, maps and curves.
# Needs xvfb, xdotool, imagemagick and a software OpenGL.
#
#   .ci/window-pictures.sh [BURNISH [FOLDER]]
set -eu
cd "$(dirname "$0")/.."

burnish=${1:-target/release/burnish}
folder=${2:-screenshots}
tour=$(mktemp -d)
trap 'rm -rf "$tour"' EXIT
for theme in dark light; do
    for size in 1280x720 1920x1080; do
        xvfb-run -a -s "-screen 0 ${size}x24" "$burnish" --size "$size" "--$theme" \
            --exit-after 45 --screenshot "$folder/window_${theme}_$size.png"
    done
    for size in 900x600 1280x720 1920x1080; do
        rm -f "$tour"/*
        SIZE=$size THEME=$theme .ci/window-tour.sh "$burnish" "$tour"
        montage "$tour"/*-compared.png "$tour"/*-pixel.png "$tour"/*-lobes.png "$tour"/*-errors.png \
            "$tour"/*-noise-map.png "$tour"/*-sheet-made.png -tile 2x3 \
            -geometry 696x+4+4 -depth 8 "png24:$folder/tour_${theme}_$size.png"
    done
done
