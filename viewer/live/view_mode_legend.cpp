#include "viewer/live/view_mode_legend.h"

namespace gigabake {

std::string view_mode_legend(ViewMode mode) {
  switch (mode) {
    case ViewMode::lit:
      return "as the eye sees it: sun, sky and air on the surface's colours";
    case ViewMode::albedo:
      return "the surface's own colours, without light";
    case ViewMode::normal:
      return "where the surface faces: red east, green north, blue up, each from 0 (the other way) to 255";
    case ViewMode::coverage:
      return "how much of a voxel is surface: white all of it, black none";
    case ViewMode::lod:
      return "level of the voxels: 0 (finest) red, 1 yellow, 2 green, 3 cyan, 4 blue, 5 magenta; from 6 on the same, "
             "darker";
    case ViewMode::cell:
      return "one colour for each cell, that is for each shard; neighbours may share one";
    case ViewMode::requests:
      return "red where finer voxels were asked for and are not here yet, green where all is";
    case ViewMode::sun:
      return "what the sun alone lights, with the shadows that surfaces cast";
    case ViewMode::sky:
      return "what the sky alone lights, as much of it as a surface sees, and the surface that stands before it";
    case ViewMode::shadow:
      return "how much of the sun a surface sees: white all of it, black none";
    case ViewMode::height:
      return "height above the scene's lowest voxel: blue the lowest, then green, yellow, brown, white the highest";
    case ViewMode::slope:
      return "slope: green level, yellow 27°, red 45°, dark red 63° and steeper; violet hangs over";
  }
  return "";
}

}  // namespace gigabake
