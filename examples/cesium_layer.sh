#!/usr/bin/env bash
# cesium_layer.sh SCENE TILES [PORT]: exports SCENE as voxel 3D Tiles with a CesiumJS page, and serves the page at
# http://localhost:PORT (8000). A second run rewrites only tiles that changed.
#
#   examples/cesium_layer.sh town tiles
set -euo pipefail
gigabake=${GIGABAKE:-gigabake}
scene=$1 tiles=$2 port=${3:-8000}

update=()
[ ! -e "$tiles" ] || update=(--update)
"$gigabake" export "$scene" --to 3dtiles -o "$tiles" "${update[@]}"
exec python3 -m http.server --bind 127.0.0.1 --directory "$tiles" "$port"
