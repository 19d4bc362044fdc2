#!/bin/sh
# Tracks many recordings, one a job. recordings.txt names one folder or video file a line:
#
#     sbatch --array=1-$(wc -l < recordings.txt) track.sh recordings.txt --rig rig.toml
#
# The angles of recordings/monday go to takes/monday.csv. Submit the same line again after a failure: takes
# that are there are kept.
#SBATCH --job-name=phalanx-track
#SBATCH --requeue
set -eu
list=$1
shift
recording=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$list")
take=takes/$(basename "$recording").csv
mkdir -p takes
[ -e "$take" ] && exit 0
exec phalanx track "$recording" --out "$take" "$@"
