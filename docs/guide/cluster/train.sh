#!/bin/sh
# Trains in parts, one a job:
#
#     sbatch --array=1-16 train.sh 16 --rig rig.toml --preset best
#     phalanx merge parts/* --out hand.phalanx
#
# A job that was killed leaves no part. Submit the same line again: parts that are there are kept, and only
# missing ones are done.
#SBATCH --job-name=phalanx-train
#SBATCH --requeue
set -eu
count=$1
shift
part=parts/$SLURM_ARRAY_TASK_ID-of-$count
mkdir -p parts
[ -e "$part" ] && exit 0
exec phalanx train --shard "$SLURM_ARRAY_TASK_ID/$count" --out "$part" "$@"
