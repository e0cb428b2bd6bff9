#!/bin/sh
# Smooths a cloud larger than memory on a Slurm cluster: every tile is an element of a job array.
#
#     sh smooth.sh JOB OUT IN...
#
# JOB is a folder that all nodes see. A node that is lost has its tiles requeued: what is there complete is not made
# again. RFSMOOTH names the command where it is not in the path; TILE_POINTS says how large tiles are at most.
set -eu
: "${RFSMOOTH:=rfsmooth}" "${TILE_POINTS:=5M}"
job=$1 out=$2
shift 2
"$RFSMOOTH" tiles plan --tile-points "$TILE_POINTS" "$@" "$job"
last=$(($("$RFSMOOTH" tiles status "$job" --json | sed -n 's/.*"tiles": \([0-9]*\).*/\1/p') - 1))

# submit AFTER ARRAY STEP...: a step, once the job AFTER has ended well; its number.
submit() {
  after=$1 array=$2
  shift 2
  sbatch --parsable --requeue ${after:+--dependency=afterok:$after} ${array:+--array=$array} \
    --output="$job/slurm-%A_%a.log" --wrap "\"$RFSMOOTH\" tiles $*"
}
measured=$(submit "" "0-$last" measure "'$job'" '$SLURM_ARRAY_TASK_ID')
settled=$(submit "$measured" "" settle "'$job'")
smoothed=$(submit "$settled" "0-$last" run "'$job'" '$SLURM_ARRAY_TASK_ID')
submit "$smoothed" "" join "'$job'" "'$out'"
