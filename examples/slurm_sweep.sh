#!/usr/bin/env bash
# slurm_sweep.sh SOURCE FOLDER MM… [-- OPTION…]: bakes SOURCE at several voxel sizes, given in millimetres.
# Each size is a task of one job array and writes FOLDER/MM. Tasks restart after time limits and failures.
#
#   examples/slurm_sweep.sh tileset.json sweep 500 250 125 -- --nodes 8 --ntasks-per-node 4 --time 4:00:00
set -euo pipefail
source=$1 folder=$2
shift 2
sizes=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  sizes+=("$1")
  shift
done
[ $# -eq 0 ] || shift

array=$(IFS=, && echo "${sizes[*]}")
sbatch --parsable --array "$array" "$@" "$(dirname "$0")/../cluster/gigabake.sbatch" \
  bake "$source" -o "$folder/%a" --voxel-size %ae-3
