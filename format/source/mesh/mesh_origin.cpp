#include "format/source/mesh/mesh_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lattice/transform.h"

namespace gigabake {
namespace {

std::array<double, 3> middle_of(std::span<const std::array<double, 3>> positions) {
  constexpr double far_m = 10000;
  std::array<double, 3> low{0, 0, 0}, high{0, 0, 0};
  bool is_far = false, is_first = true;
  for (const auto& p : positions) {
    if (!std::isfinite(p[0] + p[1] + p[2])) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = is_first ? p[c] : std::min(low[c], p[c]);
      high[c] = is_first ? p[c] : std::max(high[c], p[c]);
      is_far |= std::fabs(p[c]) > far_m;
    }
    is_first = false;
  }
  if (!is_far) return {0, 0, 0};
  return {std::round((low[0] + high[0]) / 2), std::round((low[1] + high[1]) / 2), std::round((low[2] + high[2]) / 2)};
}

}  // namespace

MeshOrigin::MeshOrigin(const TileRef& tile, std::span<const std::array<double, 3>> positions)
    : at_(middle_of(positions)),
      scene_from_local_(tile.scene_from_tile * z_up_from<World, World>(tile.gltf_up) *
                        translation<World, Local>(at_[0], at_[1], at_[2])) {}

void MeshOrigin::add_vertex(const std::array<double, 3>& position, Primitive& to) const {
  for (std::size_t c = 0; c < 3; ++c) to.position.push_back(float(position[c] - at_[c]));
}

float float_step_of(std::span<const std::array<double, 3>> positions) {
  float largest = 0;
  for (const auto& p : positions)
    for (const double v : p)
      if (std::isfinite(v)) largest = std::max(largest, float(std::fabs(v)));
  return largest > 0 ? std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest : 0;
}

}  // namespace gigabake
