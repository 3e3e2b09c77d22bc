#include "kernels/cpu/mip/end_branches.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "kernels/body/mip/branch_error.h"
#include "kernels/body/prune/node.h"
#include "kernels/cpu/mip/level_read.h"
#include "kernels/cpu/voxelize/clip.h"

namespace gigabake::kernels {
namespace {

constexpr int octant_edge = brick_edge / 2, octant_voxels = octant_edge * octant_edge * octant_edge;
/// Bricks of lod 0 along an edge of an octant of the coarsest level that may end.
constexpr int max_bricks = 1 << (max_ended_lod - 1);

int place_in_octant(const Vec3<int>& at) { return at[0] + octant_edge * at[1] + octant_edge * octant_edge * at[2]; }

/// Returns voxel `i` of a level if its whole surface lies on its plane.
std::optional<PlanarVoxel> planar_voxel_at(const Level& level, std::size_t i) {
  const std::uint8_t plane = level.directional_coverage[directional_coverage_bytes * i + directional_coverage_plane];
  if (!is_fully_planar(plane)) return std::nullopt;
  return planar_voxel(voxel_at(level, i), plane);
}

VoxelClass class_at(const Level& level, std::size_t i) {
  return level.voxel_class.empty() ? no_class : level.voxel_class[i];
}

/// Calls visit(voxel's index in the level, position in the brick) for each voxel of a brick until it returns false.
template <class Visit>
bool all_voxels(const Level& level, std::size_t brick, const Visit& visit) {
  std::size_t voxel = level.first[brick];
  for (int z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = level.mask[brick_edge * brick + std::size_t(z)]; rest != 0; rest &= rest - 1, ++voxel) {
      const int bit = std::countr_zero(rest);
      if (!visit(voxel, Vec3<int>{bit & 7, bit >> 3, z})) return false;
    }
  return true;
}

/// An octant of a level, and the voxels below it.
class Octant {
 public:
  Octant(const std::vector<Level>& levels, int lod, std::size_t brick, unsigned number, std::uint32_t codes)
      : levels_(levels), lod_(lod), codes_(codes), key_(levels[std::size_t(lod)].key[brick] << 3 | number) {
    is_planar_ = all_voxels(levels[std::size_t(lod)], brick, [&](std::size_t voxel, const Vec3<int>& at) {
      if (unsigned((at[0] >> 2) | (at[1] >> 2) << 1 | (at[2] >> 2) << 2) != number) return true;
      const std::optional<PlanarVoxel> leaf = planar_voxel_at(levels_[std::size_t(lod_)], voxel);
      const auto place = std::size_t(place_in_octant({at[0] & 3, at[1] & 3, at[2] & 3}));
      if (leaf) leaf_[place] = leaf_plane(*leaf);
      class_[place] = class_at(levels_[std::size_t(lod_)], voxel);
      return leaf.has_value();
    });
  }

  /// Returns whether its voxels describe all voxels below it.
  bool describes_branch(const Tables& tables) {
    if (!is_planar_) return false;
    for (int lod = lod_ - 1; lod >= 0; --lod)
      if (!describes_level(lod, tables)) return false;
    return covers_columns();
  }

 private:
  bool describes_level(int lod, const Tables& tables) {
    const Level& level = levels_[std::size_t(lod)];
    const int finer = lod_ - lod, depth = 3 * (finer - 1);
    const auto first = std::lower_bound(level.key.begin(), level.key.end(), key_ << depth),
               end = std::lower_bound(first, level.key.end(), (key_ + 1) << depth);
    for (auto key = first; key != end; ++key) {
      const auto brick = std::size_t(key - level.key.begin());
      const Vec3<int> from = static_cast<Vec3<int>>(demorton(*key - (key_ << depth)));
      if (lod == 0) finest_[brick_number(from)] = &level.mask[brick_edge * brick];
      const bool is_described = all_voxels(level, brick, [&](std::size_t voxel, const Vec3<int>& at) {
        return describes_voxel(level, voxel, from * brick_edge + at, finer, tables);
      });
      if (!is_described) return false;
    }
    return true;
  }

  /// `at` is the voxel's position in the octant.
  bool describes_voxel(const Level& level, std::size_t voxel, const Vec3<int>& at, int finer, const Tables& tables) {
    const auto place = std::size_t(place_in_octant(at >> finer));
    const std::optional<LeafPlane>& leaf = leaf_[place];
    const std::optional<PlanarVoxel> planar = planar_voxel_at(level, voxel);
    if (!leaf || !planar || class_at(level, voxel) != class_[place]) return false;
    const int edge = 1 << finer;
    const Vec3<int> in_leaf = at - (at >> finer) * edge;
    return describes(*leaf, *planar, in_leaf * 2 + Vec3<int>::all(1 - edge), finer, codes_, tables);
  }

  /// Returns whether a lod-0 voxel exists wherever the octant's planes cross the centre line of a column.
  bool covers_columns() const {
    const int edge = 1 << lod_;
    for (int at = 0; at < octant_voxels; ++at) {
      if (!leaf_[std::size_t(at)]) continue;
      const Vec3<int> low = Vec3<int>{at & 3, at >> 2 & 3, at >> 4} * edge;
      for (int column = 0; column < edge * edge; ++column)
        if (!covers_column(*leaf_[std::size_t(at)], low, column % edge, column / edge)) return false;
    }
    return true;
  }

  /// `low` is the lowest lod-0 voxel of the leaf in the octant.
  bool covers_column(const LeafPlane& leaf, const Vec3<int>& low, int u, int v) const {
    const ColumnPart part = covered_part(leaf, lod_, u, v, codes_);
    if (part.is_empty) return true;
    Vec3<int> at = low;
    at[leaf.u] += u;
    at[leaf.v] += v;
    const std::int64_t last = octant_edge << lod_, from = low[leaf.axis];
    for (std::int64_t z = std::max(from + part.low, std::int64_t(0)); z <= std::min(from + part.high, last - 1); ++z) {
      at[leaf.axis] = int(z);
      if (exists(at)) return true;
    }
    return false;
  }

  bool exists(const Vec3<int>& at) const {
    const std::uint64_t* mask = finest_[brick_number(at >> 3)];
    return mask != nullptr && (mask[at[2] & 7] >> ((at[0] & 7) + 8 * (at[1] & 7)) & 1) != 0;
  }

  static std::size_t brick_number(const Vec3<int>& brick) {
    return std::size_t(brick[0] + max_bricks * (brick[1] + max_bricks * brick[2]));
  }

  const std::vector<Level>& levels_;
  int lod_;
  std::uint32_t codes_;
  std::uint64_t key_;  ///< of the bricks that the octant is above
  bool is_planar_ = false;
  std::array<std::optional<LeafPlane>, octant_voxels> leaf_;
  std::array<VoxelClass, octant_voxels> class_{};
  std::array<const std::uint64_t*, max_bricks * max_bricks * max_bricks> finest_{};
};

/// The octants that end, as bits of each brick of a level.
using EndedOctants = std::vector<std::uint8_t>;

/// Returns the octants of level `lod` that end. `below` has the octants that end on the next finer level.
EndedOctants ended_octants(const std::vector<Level>& levels, int lod, const EndedOctants& below, std::uint32_t codes,
                           const ThreadPool& pool) {
  const Level &level = levels[std::size_t(lod)], &finer = levels[std::size_t(lod) - 1];
  EndedOctants ended(level.key.size());
  pool.parallel_for(level.key.size(), 64, [&](std::size_t begin, std::size_t end, int) {
    const Tables tables = TableStore::host().view();
    for (std::size_t b = begin; b < end; ++b) {
      auto child =
          std::size_t(std::lower_bound(finer.key.begin(), finer.key.end(), level.key[b] << 3) - finer.key.begin());
      for (; child < finer.key.size() && parent_key(finer.key[child]) == level.key[b]; ++child) {
        const bool all_end = lod == 1 || below[child] == occupied_octants(&finer.mask[brick_edge * child]);
        const auto number = unsigned(octant_of(finer.key[child]));
        if (all_end && Octant(levels, lod, b, number, codes).describes_branch(tables))
          ended[b] = std::uint8_t(ended[b] | 1u << number);
      }
    }
  });
  return ended;
}

/// Returns the keys of the bricks of level `lod` that the level above describes, ascending.
std::vector<std::uint64_t> described_bricks(const Level& level, const Level& above, const EndedOctants& ended,
                                            const std::vector<std::uint64_t>& described_above) {
  std::vector<std::uint64_t> described;
  std::size_t parent = 0;
  for (const std::uint64_t key : level.key) {
    while (above.key[parent] != parent_key(key)) ++parent;
    if ((ended[parent] >> octant_of(key) & 1) != 0 ||
        std::binary_search(described_above.begin(), described_above.end(), parent_key(key)))
      described.push_back(key);
  }
  return described;
}

}  // namespace

void end_branches(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool) {
  if (codes == 0 || levels.empty() || levels[0].directional_coverage.empty()) return;
  const int coarsest = std::min(max_ended_lod, int(levels.size()) - 1);
  std::vector<EndedOctants> ended(1);
  for (int lod = 1; lod <= coarsest; ++lod) ended.push_back(ended_octants(levels, lod, ended.back(), codes, pool));
  std::vector<std::vector<std::uint64_t>> described(std::size_t(coarsest) + 1);
  for (int lod = coarsest - 1; lod >= 0; --lod) {
    const auto above = std::size_t(lod) + 1;
    described[above - 1] = described_bricks(levels[above - 1], levels[above], ended[above], described[above]);
  }
  for (int lod = 0; lod < coarsest; ++lod) {
    const std::vector<std::uint64_t>& removed = described[std::size_t(lod)];
    const auto kept_in = [&](std::uint64_t key) {
      VoxelMask mask;
      mask.fill(std::binary_search(removed.begin(), removed.end(), key) ? 0 : ~std::uint64_t(0));
      return mask;
    };
    if (!removed.empty()) keep_voxels(levels[std::size_t(lod)], kept_in, pool);
  }
}

}  // namespace gigabake::kernels
