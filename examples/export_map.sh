#!/usr/bin/env bash
# export_map.sh SCENE NAME STEP [OPTION…]: writes heights and colours of SCENE with the same pixels, for QGIS and GDAL:
# NAME-heights.tif and NAME-colours.tif. STEP is the edge of a pixel. Further options apply to both, such as --crs.
#
#   examples/export_map.sh town town 0.25 --crs EPSG:25832
set -euo pipefail
gigabake=${GIGABAKE:-gigabake}
scene=$1 name=$2 step=$3
shift 3

"$gigabake" export "$scene" --to dsm --step "$step" "$@" -o "$name-heights.tif"
"$gigabake" export "$scene" --to ortho --step "$step" "$@" -o "$name-colours.tif"
