#include "viewer/live/view_mode_legend.h"

namespace gigabake {

std::string view_mode_legend(ViewMode mode) {
  switch (mode) {
    case ViewMode::lit:
      return "the surface's colours in the light of sun and sky, seen through the air";
    case ViewMode::albedo:
      return "the surface's colours without light";
    case ViewMode::normal:
      return "direction of the surface: red east, green north, blue up, each from 0 (opposite) to 255";
    case ViewMode::coverage:
      return "coverage of a voxel: white full, black none";
    case ViewMode::lod:
      return "level of the voxels: 0 (finest) red, 1 yellow, 2 green, 3 cyan, 4 blue, 5 magenta; from 6 on the same, "
             "darker";
    case ViewMode::cell:
      return "one colour per cell (per shard); neighbours may have the same colour";
    case ViewMode::requests:
      return "red where finer voxels were requested and are not resident, green elsewhere";
    case ViewMode::sun:
      return "light of the sun only, with shadows";
    case ViewMode::sky:
      return "light of the sky only; surfaces that hide the sky reflect light instead";
    case ViewMode::shadow:
      return "visible fraction of the sun: white full, black none";
    case ViewMode::height:
      return "height above the scene's lowest voxel: blue the lowest, then green, yellow, brown, white the highest";
    case ViewMode::slope:
      return "slope: green level, yellow 27°, red 45°, dark red 63° and steeper; violet overhangs";
    case ViewMode::voxel_class:
      return "class: 0 dark grey; 1 light grey, 2 brown, 3 to 5 greens, 6 red, 7 orange, 8 purple, 9 blue, 10 sand, "
             "11 slate, 12 cyan; from 13 on the same colours again";
  }
  return "";
}

}  // namespace gigabake
