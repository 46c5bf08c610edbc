#!/usr/bin/env bash
# View cells on SLURM without Python: sbatch --array=1-64 slurm.sh SCENE FOLDER, then once all are done:
#   occlod cells merge FOLDER -o city.vlod
# FOLDER is one that all nodes see. A job that was ended goes on when it is submitted again.
#SBATCH --cpus-per-task=16
#SBATCH --requeue
set -euo pipefail
occlod cells build "$1" --work "$2" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --threads "${SLURM_CPUS_PER_TASK:-0}"
