/// Where an eye is that looks for leaks, besides its elevation and distance.
#pragma once

#include <array>
#include <string_view>

#include "lattice/rules.h"

namespace gigabake {
namespace bench {

enum class LeakEye {
  anywhere,         ///< all of the scene is at least as far as the view says
  on_lattice,       ///< as high as a multiple of 64 voxels: straight down, all rays sample at one and the same phase
  at_level_change,  ///< levels change on the surface, in the middle of the picture
};

}  // namespace bench

template <>
constexpr auto names_of<bench::LeakEye>() {
  return std::to_array<std::string_view>({"anywhere", "on a lattice plane", "where levels change"});
}

}  // namespace gigabake
