#include "format/export/derived_levels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/math/octahedral.h"
#include "core/math/srgb.h"

namespace gigabake {
namespace {

/// Returns the coverage of eight voxels as a byte from 1 to 255: the mean of the coverages in views along x, y and z.
std::uint32_t covered(const std::array<std::uint32_t, 8>& alpha) {
  std::uint32_t sum = 0;
  for (std::uint32_t axis = 1; axis < 8; axis *= 2)
    for (std::uint32_t c = 0; c < 8; ++c)
      if ((c & axis) == 0) sum += 255 * (alpha[c] + alpha[c | axis]) - alpha[c] * alpha[c | axis];
  return std::max(1u, (sum + 1530) / 3060);
}

/// Eight voxels that are combined into one.
struct Octet {
  std::array<std::uint32_t, 8> alpha{};
  std::uint32_t weight = 0;
  Vec3d colour{}, normal{};
  std::map<VoxelClass, std::uint32_t> weight_of_class{};

  void add(const DerivedLevels::Voxel& voxel) {
    const std::array<double, 256>& linear = linear_of_srgb();
    const std::uint32_t a = voxel.rgba[3];
    alpha[std::size_t((voxel.at[0] & 1) | (voxel.at[1] & 1) << 1 | (voxel.at[2] & 1) << 2)] = a;
    weight += a;
    weight_of_class[voxel.voxel_class] += a;
    Vec3d n;
    decode_octahedral(voxel.normal.data(), n.v);
    colour += Vec3d{linear[voxel.rgba[0]], linear[voxel.rgba[1]], linear[voxel.rgba[2]]} * a;
    normal += n * a;
  }

  DerivedLevels::Voxel at(const LevelIndex& place) const {
    DerivedLevels::Voxel voxel;
    voxel.at = place;
    for (std::size_t i = 0; i < 3; ++i) voxel.rgba[i] = srgb_byte(colour[i] / weight);
    voxel.rgba[3] = std::uint8_t(covered(alpha));
    encode_octahedral(normal[0], normal[1], normal[2], voxel.normal.data());
    const auto is_lighter = [](const auto& a, const auto& b) { return a.second < b.second; };
    voxel.voxel_class = std::max_element(weight_of_class.begin(), weight_of_class.end(), is_lighter)->first;
    return voxel;
  }
};

/// Sorts voxels by the position of their parent. If several voxels have the same position, keeps only the last of them.
void sort_by_place(std::vector<DerivedLevels::Voxel>& voxels) {
  std::stable_sort(voxels.begin(), voxels.end(), [](const DerivedLevels::Voxel& a, const DerivedLevels::Voxel& b) {
    const LevelIndex above_a = a.at >> 1, above_b = b.at >> 1;
    return above_a != above_b ? above_a < above_b : a.at < b.at;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (i + 1 == voxels.size() || voxels[i].at != voxels[i + 1].at) voxels[kept++] = voxels[i];
  voxels.resize(kept);
}

std::vector<DerivedLevels::Voxel> level_above(const std::vector<DerivedLevels::Voxel>& below) {
  std::vector<DerivedLevels::Voxel> above;
  for (std::size_t i = 0; i < below.size();) {
    const LevelIndex place = below[i].at >> 1;
    Octet octet;
    for (; i < below.size() && (below[i].at >> 1) == place; ++i) octet.add(below[i]);
    if (octet.weight > 0) above.push_back(octet.at(place));
  }
  return above;
}

}  // namespace

DerivedLevels::DerivedLevels(const PagedScene& scene, const LevelOwners& owners, int coarsest) {
  const int lowest = owners.coarsest();
  if (coarsest <= lowest) return;
  std::vector<Voxel> voxels;
  constexpr std::int64_t all = std::int64_t(1) << 62;
  owners.for_each(lowest, lowest, 0, 1, [&](const std::vector<LevelOwner>& shards) {
    for (const LevelOwner& owner : shards)
      ShardLevel(scene, owner.shard, lowest)
          .for_each_voxel_in(
              {Vec3i64::all(-all), Vec3i64::all(all)},
              [&](const LevelIndex& at, const std::uint8_t* rgba, const std::int8_t* normal, VoxelClass voxel_class) {
                Voxel& voxel = voxels.emplace_back();
                voxel.at = at;
                std::memcpy(voxel.rgba.data(), rgba, 4);
                std::memcpy(voxel.normal.data(), normal, 2);
                voxel.voxel_class = voxel_class;
              });
  });
  for (int lod = lowest + 1; lod <= coarsest; ++lod) {
    sort_by_place(voxels);
    voxels = levels_[lod] = level_above(voxels);
  }
}

}  // namespace gigabake
