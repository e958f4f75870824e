#!/usr/bin/env bash
# The same by GNU parallel, here or on machines that it reaches by ssh. A part that was killed is run again.
#
#   parallel.sh SCENE PASSES PARTS FOLDER [PARALLEL OPTIONS...]
#
# Such as `-j 4`, or `-S node1,node2 --workdir .` where the machines share this folder.
set -euo pipefail
scene=$1 passes=$2 parts=$3 folder=$4
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$folder"

seq "$parts" | parallel --retries 3 --joblog "$folder/parts.log" "${@:5}" \
    "$here/part.sh" "$scene" "$passes" "$parts" "$folder" {}
"${BURNISH:-burnish}" merge $(seq -f "$folder/part-%g.exr" "$parts") -o "$folder/whole.exr"
