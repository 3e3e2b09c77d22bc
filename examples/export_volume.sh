#!/usr/bin/env bash
# export_volume.sh SCENE FILE [LIMIT]: writes the finest level of SCENE that has at most LIMIT voxels (default: ten
# million) as a volume or points: FILE.vdb (OpenVDB), FILE.nvdb (NanoVDB) or FILE.ply.
#
#   examples/export_volume.sh town town.vdb
set -euo pipefail
gigabake=${GIGABAKE:-gigabake}
scene=$1 file=$2 max_voxels=${3:-10000000}

lod=$("$gigabake" info "$scene" --json | python3 -c '
import json, sys
counts = [level["voxels"] for level in json.load(sys.stdin)["lods"]]
print(next((lod for lod, voxels in enumerate(counts) if voxels <= int(sys.argv[1])), len(counts) - 1))' "$max_voxels")
echo "exporting level $lod"
"$gigabake" export "$scene" --lod "$lod" -o "$file"
