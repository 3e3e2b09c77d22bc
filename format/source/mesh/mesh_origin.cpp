#include "format/source/mesh/mesh_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/transform.h"
#include "format/source/mesh_parts.h"

namespace gigabake {
namespace {

constexpr double cell_m = 131072, last_cell = 1e12;
constexpr std::size_t max_cells = 4096;

bool is_finite(const std::array<double, 3>& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace

void PositionExtent::add(const std::array<double, 3>& p) {
  if (!is_finite(p)) return;
  for (std::size_t c = 0; c < 3; ++c) {
    low_[c] = is_empty_ ? p[c] : std::min(low_[c], p[c]);
    high_[c] = is_empty_ ? p[c] : std::max(high_[c], p[c]);
  }
  is_empty_ = false;
}

void PositionExtent::add(const PositionExtent& other) {
  if (other.is_empty_) return;
  add(other.low_);
  add(other.high_);
}

double PositionExtent::max_magnitude() const {
  double max_magnitude = 0;
  for (std::size_t c = 0; c < 3; ++c)
    max_magnitude = std::max({max_magnitude, std::fabs(low_[c]), std::fabs(high_[c])});
  return max_magnitude;
}

std::array<double, 3> PositionExtent::origin() const {
  constexpr double far_m = 10000;
  if (max_magnitude() <= far_m) return {0, 0, 0};
  // Halves are added, because the sum of two large numbers may overflow.
  return {std::round(low_[0] / 2 + high_[0] / 2), std::round(low_[1] / 2 + high_[1] / 2),
          std::round(low_[2] / 2 + high_[2] / 2)};
}

float PositionExtent::float_step() const {
  const auto at = float(max_magnitude());
  return at > 0 ? std::nextafter(at, std::numeric_limits<float>::infinity()) - at : 0;
}

MeshOrigin::MeshOrigin(const TileRef& tile, const PositionExtent& extent)
    : at_(extent.origin()),
      float_step_(extent.float_step()),
      scene_from_local_(tile.scene_from_tile * z_up_from<World, World>(tile.gltf_up) *
                        translation<World, Local>(at_[0], at_[1], at_[2])) {}

void MeshOrigin::add_vertex(const std::array<double, 3>& position, Primitive& to) const {
  for (std::size_t c = 0; c < 3; ++c) to.position.push_back(float(position[c] - at_[c]));
}

MeshOrigins::Cell MeshOrigins::cell_of(const std::array<double, 3>& position) {
  Cell cell{};
  for (std::size_t c = 0; c < 3; ++c)
    cell[c] = std::int64_t(std::clamp(std::floor(position[c] / cell_m), -last_cell, last_cell));
  return cell;
}

void MeshOrigins::add(const std::array<double, 3>& position) {
  if (!is_finite(position)) return;
  const Cell cell = is_one_group_ ? Cell{} : cell_of(position);
  if (last_extent_ == nullptr || cell != last_cell_) {
    last_extent_ = &extents_[cell];
    last_cell_ = cell;
  }
  last_extent_->add(position);
  if (extents_.size() > max_cells) join_cells();
}

/// Merges all cells into one group. This limits the memory for meshes with very many cells, such as a mesh of the whole
/// earth.
void MeshOrigins::join_cells() {
  PositionExtent all;
  for (const auto& [cell, extent] : extents_) all.add(extent);
  extents_ = {{Cell{}, all}};
  last_extent_ = nullptr;
  is_one_group_ = true;
}

void MeshOrigins::finish() {
  std::vector<PositionExtent> groups;
  for (const auto& [first, unused] : extents_) {
    if (group_.count(first) != 0) continue;
    std::vector<Cell> reached{first};
    group_[first] = groups.size();
    PositionExtent all;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const Cell cell = reached[i];
      all.add(extents_.at(cell));
      for (int n = 0; n < 27; ++n) {
        const Cell next{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
        if (extents_.count(next) != 0 && group_.try_emplace(next, groups.size()).second) reached.push_back(next);
      }
    }
    groups.push_back(all);
  }
  if (groups.empty()) groups.emplace_back();
  for (const PositionExtent& extent : groups) origins_.emplace_back(tile_, extent);
}

std::size_t MeshOrigins::group_of(const std::array<double, 3>& position) const {
  if (origins_.size() == 1 || !is_finite(position)) return 0;
  const auto group = group_.find(cell_of(position));
  return group == group_.end() ? 0 : group->second;
}

void MeshOrigins::place(Primitive&& primitive, std::span<const std::uint32_t> position_of,
                        std::span<const std::array<double, 3>> positions, const Take& take) const {
  const auto fill_in = [&](Primitive&& piece, std::span<const std::uint32_t> from, const MeshOrigin& origin) {
    for (const std::uint32_t v : from) origin.add_vertex(positions[v], piece);
    take(std::move(piece), origin);
  };
  std::map<std::size_t, std::vector<std::uint32_t>> corners;  // indices by group
  if (origins_.size() > 1)
    for (std::size_t i = 0; i < primitive.index.size(); i += 3) {
      const auto triangle = primitive.index.begin() + std::ptrdiff_t(i);
      auto& list = corners[group_of(positions[position_of[*triangle]])];
      list.insert(list.end(), triangle, triangle + 3);
    }
  if (corners.size() < 2) {
    const std::size_t group = corners.empty() ? 0 : corners.begin()->first;
    return fill_in(std::move(primitive), position_of, origins_[group]);
  }
  for (auto& [group, list] : corners) {
    std::vector<std::uint32_t> from;
    Primitive piece = with_corners(primitive, std::move(list), from);
    for (std::uint32_t& v : from) v = position_of[v];
    fill_in(std::move(piece), from, origins_[group]);
  }
}

}  // namespace gigabake
