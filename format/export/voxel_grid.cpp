#include "format/export/voxel_grid.h"

#include <algorithm>
#include <cmath>

#include "core/math/octahedral.h"

namespace gigabake {
namespace {

using NormalBytes = std::array<std::uint8_t, 3>;

/// Returns three bytes for the direction of an octahedral code. The candidates are the 27 triples around the rounded
/// direction. The result is the candidate nearest in direction that encodes to the same code. Some rounded directions
/// encode to a different code.
NormalBytes nearest_that_comes_back(const std::int8_t oct[2]) {
  Vec3d n;
  decode_octahedral(oct, n.v);
  std::int8_t canonical[2];
  encode_octahedral(n[0], n[1], n[2], canonical);  // on the folds of the octahedron, a direction has two codes
  NormalBytes best{};
  double best_cosine = -2;
  for (int step = 0; step < 27; ++step) {
    const Vec3<int> offset{step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
    const auto code = Vec3<int>::by_axis(
        [&](std::size_t c) { return std::clamp(int(std::lround(n[c] * 127)) + offset[c], -127, 127); });
    const Vec3d v = Vec3d(code) / 127;
    std::int8_t back[2];
    encode_octahedral(v[0], v[1], v[2], back);
    if (back[0] != canonical[0] || back[1] != canonical[1]) continue;
    if (const double cosine = dot(v, n) / length(v); cosine > best_cosine) {
      best_cosine = cosine;
      best = {std::uint8_t(code[0] + 128), std::uint8_t(code[1] + 128), std::uint8_t(code[2] + 128)};
    }
  }
  return best;
}

/// Returns the table of byte triples, indexed by the two bytes of the octahedral code (first byte lowest).
const std::vector<NormalBytes>& all_normal_bytes() {
  static const std::vector<NormalBytes> table = [] {
    std::vector<NormalBytes> all(1 << 16);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::int8_t oct[2] = {std::int8_t(i & 255), std::int8_t(i >> 8)};
      all[i] = nearest_that_comes_back(oct);
    }
    return all;
  }();
  return table;
}

template <std::size_t n>
void widen(std::array<std::uint8_t, n>& minimum, std::array<std::uint8_t, n>& greatest, const std::uint8_t* low,
           const std::uint8_t* high) {
  for (std::size_t c = 0; c < n; ++c) {
    minimum[c] = std::min(minimum[c], low[c]);
    greatest[c] = std::max(greatest[c], high[c]);
  }
}

}  // namespace

std::array<std::uint8_t, 3> normal_bytes(const std::int8_t oct[2]) {
  return all_normal_bytes()[std::uint8_t(oct[0]) | std::size_t(std::uint8_t(oct[1])) << 8];
}

void VoxelStatistics::add(const std::uint8_t* rgba, const std::uint8_t* normal) {
  ++voxels;
  widen(min_rgba, max_rgba, rgba, rgba);
  widen(min_normal, max_normal, normal, normal);
}

void VoxelStatistics::add(VoxelClass voxel_class) {
  min_class = std::min(min_class, voxel_class);
  max_class = std::max(max_class, voxel_class);
}

void VoxelStatistics::add(const VoxelStatistics& other) {
  voxels += other.voxels;
  widen(min_rgba, max_rgba, other.min_rgba.data(), other.max_rgba.data());
  widen(min_normal, max_normal, other.min_normal.data(), other.max_normal.data());
  min_class = std::min(min_class, other.min_class);
  max_class = std::max(max_class, other.max_class);
}

VoxelGrid::VoxelGrid(std::uint32_t tile_edge, const SceneHeader& scene, GridOrder order)
    : edge_(tile_edge + 2), has_normals_(scene.has_normals), order_(order) {
  const std::size_t voxels = std::size_t(edge_) * edge_ * edge_;
  rgba_.resize(4 * voxels);
  normals_.resize(4 * voxels);
  if (scene.has_classes) classes_.resize(voxels);
}

void VoxelGrid::clear(const Box3i64& padded_box) {
  lowest_ = padded_box.min;
  if (is_empty_) return;
  is_empty_ = true;
  std::fill(rgba_.begin(), rgba_.end(), std::uint8_t(0));
  std::fill(normals_.begin(), normals_.end(), std::uint8_t(0));
  std::fill(classes_.begin(), classes_.end(), 0.0f);
}

std::size_t VoxelGrid::place_of(std::size_t x, std::size_t y, std::size_t z) const {
  const std::size_t e = edge_;
  return order_ == GridOrder::y_up ? x + e * (z + e * (e - 1 - y)) : x + e * (y + e * z);
}

void VoxelGrid::set(const LevelIndex& at, const std::uint8_t* rgba, const std::int8_t* normal, VoxelClass voxel_class) {
  const std::size_t place =
      4 * place_of(std::size_t(at[0] - lowest_[0]), std::size_t(at[1] - lowest_[1]), std::size_t(at[2] - lowest_[2]));
  std::copy_n(rgba, 4, rgba_.begin() + std::ptrdiff_t(place));
  const NormalBytes bytes = has_normals_ ? normal_bytes(normal) : NormalBytes{128, 128, 128};
  std::copy(bytes.begin(), bytes.end(), normals_.begin() + std::ptrdiff_t(place));
  normals_[place + 3] = 255;
  if (!classes_.empty()) classes_[place / 4] = voxel_class;
  is_empty_ = false;
}

VoxelStatistics VoxelGrid::statistics() const {
  VoxelStatistics statistics;
  if (is_empty_) return statistics;
  const std::size_t e = edge_;
  for (std::size_t slow = 1; slow + 1 < e; ++slow)  // any axis: padding is on all sides
    for (std::size_t middle = 1; middle + 1 < e; ++middle)
      for (std::size_t fast = 1; fast + 1 < e; ++fast)
        if (const std::size_t place = 4 * (fast + e * (middle + e * slow)); normals_[place + 3] != 0) {
          statistics.add(&rgba_[place], &normals_[place]);
          if (!classes_.empty()) statistics.add(VoxelClass(classes_[place / 4]));
        }
  return statistics;
}

}  // namespace gigabake
