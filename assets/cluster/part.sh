#!/usr/bin/env bash
# One part of a picture: begun, or gone on with from its last checkpoint if an earlier run of it was ended or
# killed. Its last lines make the file that says that it is done.
#
#   part.sh SCENE PASSES PARTS FOLDER [PART]
#
# Without PART it is the number of the task in its Slurm job array. EVERY is the seconds between checkpoints,
# THREADS the threads (0, one a core), BURNISH the program.
set -euo pipefail
scene=$1 passes=$2 parts=$3 folder=$4 part=${5:-${SLURM_ARRAY_TASK_ID:?no PART given}}
burnish=${BURNISH:-burnish}
file=$folder/part-$part.exr
options=(--every "${EVERY:-60}" --threads "${THREADS:-${SLURM_CPUS_PER_TASK:-0}}")

if [ -e "$file" ]; then
    "$burnish" resume "$file" "${options[@]}"
else
    "$burnish" render "$scene" --passes "$passes" --part "$part/$parts" --checkpoint "$file" "${options[@]}"
fi
touch "$folder/part-$part.done"
