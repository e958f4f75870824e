#!/bin/sh
# Takes the window's own pictures for screenshots/, under a virtual display. Needs xvfb and a software
# OpenGL.
#
#   .ci/window-pictures.sh [BURNISH [FOLDER]]
set -eu
cd "$(dirname "$0")/.."

burnish=${1:-target/release/burnish}
folder=${2:-screenshots}
for theme in dark light; do
    for size in 1280x720 1920x1080; do
        xvfb-run -a -s "-screen 0 ${size}x24" "$burnish" --size "$size" "--$theme" \
            --exit-after 45 --screenshot "$folder/window_${theme}_$size.png"
    done
done
