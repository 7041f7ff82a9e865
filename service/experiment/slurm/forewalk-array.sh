#!/bin/bash
# A campaign as a Slurm job array: task i of n walks shard i/n of a plan.
#
#   sbatch --array=1-16 --cpus-per-task=8 forewalk-array.sh PLAN.json RESULTS
#   forewalk merge RESULTS/shard-* --out RESULTS/all && forewalk report RESULTS/all
#
# Shards lie in RESULTS/shard-1, ...; RESULTS and the plan have to be seen from all nodes. What is
# walked is kept: a task that is killed, preempted or out of time goes on where it was when it runs
# again, by itself (preempted, out of time) or after `scontrol requeue JOB_TASK` (killed). FOREWALK
# names the program where it is not in PATH.
#
#SBATCH --job-name=forewalk
#SBATCH --output=forewalk-%A_%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@60
set -u

stop() {
  echo "forewalk-array.sh: $1" >&2
  exit 2
}

[ $# -eq 2 ] || stop "usage: sbatch --array=1-N forewalk-array.sh PLAN.json RESULTS"
[ -n "${SLURM_ARRAY_TASK_ID:-}" ] || stop "no array task: submit with sbatch --array=1-N"
# Shards are numbered 1 to n without gaps, or some would never be walked.
if [ "$SLURM_ARRAY_TASK_MIN" -ne 1 ] || [ "$SLURM_ARRAY_TASK_MAX" -ne "$SLURM_ARRAY_TASK_COUNT" ]; then
  stop "the array has to be 1-N, it is $SLURM_ARRAY_TASK_MIN to $SLURM_ARRAY_TASK_MAX with $SLURM_ARRAY_TASK_COUNT tasks"
fi

"${FOREWALK:-forewalk}" experiment "$1" --out "$2/shard-$SLURM_ARRAY_TASK_ID" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --threads "${SLURM_CPUS_PER_TASK:-1}" &
walk=$!
# Slurm warns the shell; the program ends softly, keeping what is done.
trap 'kill -TERM "$walk" 2>/dev/null' TERM
wait "$walk"
status=$?
while kill -0 "$walk" 2>/dev/null; do # the trap cut the first wait short
  wait "$walk"
  status=$?
done

if [ "$status" -eq 130 ]; then # stopped half-way
  echo "shard $SLURM_ARRAY_TASK_ID goes on when the task runs again"
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$status"
