/// The position of an eye for leak tests, in addition to its elevation and distance.
#pragma once

#include <array>
#include <string_view>

#include "core/base/rules.h"

namespace gigabake {
namespace bench {

enum class LeakEye {
  anywhere,         ///< the whole scene is at least as far away as the view specifies
  on_lattice,       ///< the eye's height is a multiple of 64 voxels: all rays straight down sample at the same phase
  at_level_change,  ///< the level changes on the surface in the middle of the image
};

}  // namespace bench

template <>
constexpr auto names_of<bench::LeakEye>() {
  return std::to_array<std::string_view>({"anywhere", "on a lattice plane", "where levels change"});
}

}  // namespace gigabake
