#include "format/source/mesh/mesh_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lattice/transform.h"

namespace gigabake {
namespace {

PositionExtent extent_of(std::span<const std::array<double, 3>> positions) {
  PositionExtent extent;
  for (const auto& p : positions) extent.add(p);
  return extent;
}

}  // namespace

void PositionExtent::add(const std::array<double, 3>& p) {
  constexpr double far_m = 10000;
  for (const double v : p)
    if (std::isfinite(v)) largest_ = std::max(largest_, float(std::fabs(v)));
  if (!std::isfinite(p[0] + p[1] + p[2])) return;
  for (std::size_t c = 0; c < 3; ++c) {
    low_[c] = is_empty_ ? p[c] : std::min(low_[c], p[c]);
    high_[c] = is_empty_ ? p[c] : std::max(high_[c], p[c]);
    is_far_ |= std::fabs(p[c]) > far_m;
  }
  is_empty_ = false;
}

std::array<double, 3> PositionExtent::origin() const {
  if (!is_far_) return {0, 0, 0};
  return {std::round((low_[0] + high_[0]) / 2), std::round((low_[1] + high_[1]) / 2),
          std::round((low_[2] + high_[2]) / 2)};
}

float PositionExtent::float_step() const {
  return largest_ > 0 ? std::nextafter(largest_, std::numeric_limits<float>::infinity()) - largest_ : 0;
}

MeshOrigin::MeshOrigin(const TileRef& tile, const PositionExtent& extent)
    : at_(extent.origin()),
      scene_from_local_(tile.scene_from_tile * z_up_from<World, World>(tile.gltf_up) *
                        translation<World, Local>(at_[0], at_[1], at_[2])) {}

MeshOrigin::MeshOrigin(const TileRef& tile, std::span<const std::array<double, 3>> positions)
    : MeshOrigin(tile, extent_of(positions)) {}

void MeshOrigin::add_vertex(const std::array<double, 3>& position, Primitive& to) const {
  for (std::size_t c = 0; c < 3; ++c) to.position.push_back(float(position[c] - at_[c]));
}

}  // namespace gigabake
