#include "kernels/cpu/voxelize/quantize_groups.h"

#include <array>
#include <bit>
#include <cstring>

#include "core/base/thread_pool.h"
#include "core/octree/brick.h"
#include "kernels/body/voxelize/quantize_groups.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t bricks_per_range = 512;

/// The voxels of a brick, and the groups (brick, octant, 2×2×2) that contain each voxel.
class GroupedBrick {
 public:
  explicit GroupedBrick(const std::uint64_t* mask) {
    for (int z = 0; z < brick_edge; ++z)
      for (std::uint64_t rest = mask[z]; rest != 0; rest &= rest - 1, ++voxels_) {
        const int group = group_share(64 * z + std::countr_zero(rest));
        group_[std::size_t(voxels_)] = std::uint8_t(group);
        for (const int share : {0, octant_share(group), group}) ++count_[std::size_t(share)];
      }
  }

  int voxels() const { return voxels_; }
  std::uint32_t count(int share) const { return count_[std::size_t(share)]; }
  /// Returns the groups that contain the voxel, largest first.
  std::array<int, 3> of(int voxel) const {
    const int group = group_[std::size_t(voxel)];
    return {0, octant_share(group), group};
  }

 private:
  int voxels_ = 0;
  std::array<std::uint8_t, brick_voxels> group_;
  std::array<std::uint32_t, shares> count_{};
};

/// Quantizes channels [begin, end) of the voxels' bytes together. Each voxel takes the common value of the largest
/// group that contains it and whose channels all fit the error bound.
void quantize_codes(const GroupedBrick& brick, std::uint8_t* bytes, int stride, int begin, int end,
                    std::uint32_t codes) {
  std::array<std::array<CodeRange, 3>, shares> range{};
  for (int v = 0; v < brick.voxels(); ++v)
    for (const int share : brick.of(v))
      for (int c = begin; c < end; ++c) range[std::size_t(share)][std::size_t(c - begin)].add(bytes[stride * v + c]);
  std::array<bool, shares> fits{};
  for (int s = 0; s < shares; ++s) {
    fits[std::size_t(s)] = true;
    for (int c = begin; c < end; ++c) fits[std::size_t(s)] &= range[std::size_t(s)][std::size_t(c - begin)].fits(codes);
  }
  for (int v = 0; v < brick.voxels(); ++v)
    for (const int share : brick.of(v)) {
      if (!fits[std::size_t(share)]) continue;
      for (int c = begin; c < end; ++c)
        bytes[stride * v + c] = range[std::size_t(share)][std::size_t(c - begin)].value(brick.count(share), codes);
      break;
    }
}

void quantize_normals(const GroupedBrick& brick, std::int8_t* normal, std::uint32_t codes) {
  const std::int16_t* units = TableStore::host().view().unit_normal;
  const auto unit = [&](std::uint16_t code) {
    const std::int16_t* n = units + 4 * std::size_t(code);
    return Vec3<std::int16_t>{n[0], n[1], n[2]};
  };
  std::array<std::uint16_t, brick_voxels> code;
  std::memcpy(code.data(), normal, 2 * std::size_t(brick.voxels()));
  std::array<NormalRange, shares> range{};
  for (int v = 0; v < brick.voxels(); ++v)
    for (const int share : brick.of(v)) range[std::size_t(share)].add(unit(code[std::size_t(v)]));
  for (int s = 0; s < shares; ++s)
    if (brick.count(s) != 0) range[std::size_t(s)].choose();
  for (int v = 0; v < brick.voxels(); ++v)
    for (const int share : brick.of(v)) {
      NormalRange& r = range[std::size_t(share)];
      r.fits = r.fits && within_chord(unit(code[std::size_t(v)]), unit(r.value), codes);
    }
  for (int v = 0; v < brick.voxels(); ++v)
    for (const int share : brick.of(v)) {
      if (!range[std::size_t(share)].fits) continue;
      std::memcpy(normal + 2 * v, &range[std::size_t(share)].value, 2);
      break;
    }
}

}  // namespace

void quantize_groups(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool) {
  if (codes == 0) return;
  for (Level& level : levels)
    pool.parallel_for(level.key.size(), bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t b = begin; b < end; ++b) {
        const GroupedBrick brick(&level.mask[8 * b]);
        std::uint8_t* rgba = &level.rgba[4 * level.first[b]];
        quantize_codes(brick, rgba, 4, 0, 3, codes);
        quantize_codes(brick, rgba, 4, 3, 4, codes);
        if (!level.directional_coverage.empty())
          quantize_codes(brick, &level.directional_coverage[directional_coverage_bytes * level.first[b]],
                         int(directional_coverage_bytes), 0, 3, codes);
        if (!level.normal.empty()) quantize_normals(brick, &level.normal[2 * level.first[b]], codes);
      }
    });
}

}  // namespace gigabake::kernels
