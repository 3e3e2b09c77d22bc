#!/usr/bin/env bash
# fly_through.sh SOURCE SCENE VOXEL_M [OPTION…]: bakes SOURCE, renders SCENE.png, and opens SCENE for flying: in a
# window, or without a display in a browser. OPTION… are options of `gigabake view` or `gigabake serve`.
#
#   examples/fly_through.sh tileset.json town 0.25
set -euo pipefail
gigabake=${GIGABAKE:-gigabake}
source=$1 scene=$2 voxel_m=$3
shift 3

"$gigabake" bake "$source" -o "$scene" --voxel-size "$voxel_m"
"$gigabake" render "$scene" -o "$scene.png" --shadows on
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  exec "$gigabake" view "$scene" "$@"
else
  exec "$gigabake" serve "$scene" "$@"
fi
