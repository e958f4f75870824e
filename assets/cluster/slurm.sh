#!/usr/bin/env bash
# A picture by a Slurm job array, a task a part. Tasks that were killed, and those of nodes that have died, are
# run again, and no others; then the parts are merged into FOLDER/whole.exr.
#
#   slurm.sh SCENE PASSES PARTS FOLDER [SBATCH OPTIONS...]
#
# FOLDER and SCENE are on a file system that all nodes have. ATTEMPTS is how often parts are tried, 3 if not set.
set -euo pipefail
scene=$1 passes=$2 parts=$3 folder=$4
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$folder"

for attempt in $(seq "${ATTEMPTS:-3}"); do
    left=()
    for part in $(seq "$parts"); do
        [ -e "$folder/part-$part.done" ] || left+=("$part")
    done
    [ ${#left[@]} = 0 ] && break
    echo "attempt $attempt: parts ${left[*]}"
    list=$(IFS=,; echo "${left[*]}")
    # It ends when all of the tasks have, with their worst exit code.
    sbatch --wait --array="$list" --requeue --output="$folder/part-%a.log" --open-mode=append "${@:5}" \
        "$here/part.sh" "$scene" "$passes" "$parts" "$folder" || true
done
# A part that is not there, or not done, is named.
for part in $(seq "$parts"); do
    [ -e "$folder/part-$part.done" ] || { echo "part $part is not done: $folder/part-$part.log"; exit 1; }
done
"${BURNISH:-burnish}" merge $(seq -f "$folder/part-%g.exr" "$parts") -o "$folder/whole.exr"
