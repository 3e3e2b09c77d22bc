#include "format/edit/lattice_mesh.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "core/octree/brick.h"

namespace gigabake {
namespace {

/// Triangles are listed by blocks of 2^grid_bits sub-voxels along x and y: a brick.
constexpr int grid_bits = subvoxel_bits + 3;
constexpr std::size_t max_entries = std::size_t(1) << 25;
/// Boxes with more blocks are not tested against each block.
constexpr std::int64_t max_box_blocks = 9;

FixedPoint in_plane(const Vec3i64& p) { return {p[0], p[1]}; }

/// Returns the crossing of a directed edge by a ray from `p` to the east. It is +1 if the edge leads to the north, -1
/// if it leads to the south, and 0 if the ray misses it.
int crossing(const FixedPoint& from, const FixedPoint& to, const FixedPoint& p) {
  const bool is_up = from.y <= to.y;
  const FixedPoint &low = is_up ? from : to, &high = is_up ? to : from;
  if (!(low.y <= p.y && p.y < high.y) || side_of(low, high, p) <= 0) return 0;
  return is_up ? 1 : -1;
}

/// Returns whether the triangle's plane is strictly above `p`.
/// Range   The triangle's projection along z has an area.
bool is_above(const Vec3i64& a, const Vec3i64& b, const Vec3i64& c, const Vec3i64& p) {
  using Wide = __int128;
  const Vec3i64 n = cross(b - a, c - a), v = p - a;
  const Wide height = Wide(n[0]) * v[0] + Wide(n[1]) * v[1] + Wide(n[2]) * v[2];
  return n[2] > 0 ? height < 0 : height > 0;
}

}  // namespace

LatticeMesh::LatticeMesh(std::vector<Vec3i64> positions, std::vector<Triangle> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)) {
  low_ = high_ = positions_.at(0);
  for (const Vec3i64& p : positions_) low_ = min_by_axis(low_, p), high_ = max_by_axis(high_, p);
  std::size_t entries = 0;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vec3i64 &a = positions_[triangles_[t][0]], &b = positions_[triangles_[t][1]],
                  &c = positions_[triangles_[t][2]];
    const Vec3i64 first = min_by_axis(a, min_by_axis(b, c)) >> grid_bits,
                  last = max_by_axis(a, max_by_axis(b, c)) >> grid_bits;
    entries += std::size_t((last[0] - first[0] + 1) * (last[1] - first[1] + 1));
    if (entries > max_entries)
      throw std::length_error("has too many triangles for the number of voxels that they span");
    for (std::int64_t y = first[1]; y <= last[1]; ++y)
      for (std::int64_t x = first[0]; x <= last[0]; ++x) by_block_[{x, y}].push_back(t);
  }
}

/// Returns the winding number of a triangle's projection around `p` if the triangle is above `p`, else 0.
int LatticeMesh::winding_below(const Triangle& t, const Vec3i64& p) const {
  const Vec3i64 &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
  const FixedPoint at = in_plane(p), u = in_plane(a), v = in_plane(b), w = in_plane(c);
  const int winding = crossing(u, v, at) + crossing(v, w, at) + crossing(w, u, at);
  return winding != 0 && is_above(a, b, c, p) ? winding : 0;
}

bool LatticeMesh::contains(const Vec3i64& p) const {
  const auto found = by_block_.find({p[0] >> grid_bits, p[1] >> grid_bits});
  if (found == by_block_.end()) return false;
  int winding = 0;
  for (const std::uint32_t t : found->second) winding += winding_below(triangles_[t], p);
  return winding != 0;
}

bool LatticeMesh::is_near(std::uint32_t triangle, const Vec3i64& low, const Vec3i64& high) const {
  const Triangle& t = triangles_[triangle];
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [min, max] = std::minmax({positions_[t[0]][c], positions_[t[1]][c], positions_[t[2]][c]});
    if (max < low[c] || min > high[c]) return false;
  }
  return true;
}

AreaOverlap LatticeMesh::overlap(const Vec3i64& low, const Vec3i64& high) const {
  const Vec3i64 first = low >> grid_bits, last = high >> grid_bits;
  if (last[0] - first[0] > max_box_blocks || last[1] - first[1] > max_box_blocks) return AreaOverlap::border;
  for (std::int64_t y = first[1]; y <= last[1]; ++y)
    for (std::int64_t x = first[0]; x <= last[0]; ++x)
      if (const auto found = by_block_.find({x, y}); found != by_block_.end())
        for (const std::uint32_t t : found->second)
          if (is_near(t, low, high)) return AreaOverlap::border;
  return contains(low) ? AreaOverlap::inside : AreaOverlap::outside;
}

std::optional<std::string> open_edges(const std::vector<Vec3i64>& positions,
                                      const std::vector<LatticeMesh::Triangle>& triangles) {
  std::map<std::pair<Vec3i64, Vec3i64>, int> sums;  // by edge in one direction
  for (const LatticeMesh::Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3i64 &a = positions[t[i]], &b = positions[t[(i + 1) % 3]];
      if (a != b) sums[a < b ? std::pair(a, b) : std::pair(b, a)] += a < b ? 1 : -1;
    }
  const auto open = std::count_if(sums.begin(), sums.end(), [](const auto& edge) { return edge.second != 0; });
  if (open == 0) return std::nullopt;
  return "is not closed: " + std::to_string(open) + " of " + std::to_string(sums.size()) +
         " edges do not have one triangle on each side, with the same winding";
}

}  // namespace gigabake
