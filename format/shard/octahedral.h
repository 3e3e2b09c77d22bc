/// Octahedral unit vectors in two bytes, as shards store normals.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

/// The unit vector that two bytes stand for (docs/format.md), computed in double and rounded once.
/// Source  Cigolle et al. 2014.
std::array<float, 3> unit_normal(const std::int8_t oct[2]);

}  // namespace gigabake
