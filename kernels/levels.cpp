#include "kernels/levels.h"

#include <bit>

#include "kernels/brick_run.h"
#include "kernels/mip.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t parents_per_run = 16;

/// Where each parent's children start in `fine`, and the end.
std::vector<std::size_t> parent_starts(const Level& fine) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < fine.key.size(); ++i)
    if (i == 0 || fine.key[i] >> 3 != fine.key[i - 1] >> 3) starts.push_back(i);
  starts.push_back(fine.key.size());
  return starts;
}

/// A brick's voxels at their places; the others are stale.
struct OpenBrick {
  const std::uint64_t* mask;
  Voxel voxel[brick_voxels];
};

void open_brick(const Level& level, std::size_t brick, OpenBrick& out) {
  out.mask = &level.mask[8 * brick];
  std::size_t from = level.first[brick];
  for (int word = 0; word < 8; ++word)
    for (std::uint64_t rest = out.mask[word]; rest != 0; rest &= rest - 1, ++from) {
      Voxel& v = out.voxel[64 * word + std::countr_zero(rest)];
      for (int c = 0; c < 4; ++c) v.rgba[c] = level.rgba[4 * from + c];
      for (int c = 0; c < 2; ++c) v.normal[c] = level.normal.empty() ? std::int8_t(0) : level.normal[2 * from + c];
    }
}

/// Which of the 2×2×2 voxels from (2x, 2y, 2z) exist, given the four rows (y, z) of 8 bits they stand in.
std::uint8_t present_octants(const std::uint64_t rows[4], int x) {
  std::uint64_t present = 0;
  for (int r = 0; r < 4; ++r) present |= (rows[r] >> (2 * x) & 3) << (2 * r);
  return std::uint8_t(present);
}

class ParentBuilder {
 public:
  ParentBuilder(const Level& fine, MipFilter filter)
      : fine_(fine), filter_(filter), tables_(TableStore::host().view()) {}

  /// children [begin, end) of `fine` share one parent.
  void build(std::size_t begin, std::size_t end, BrickRun& run) {
    for (std::size_t child = begin; child < end; ++child) {
      open_brick(fine_, child, open_);
      fill_octant(int(fine_.key[child] & 7));
    }
    pack(fine_.key[begin] >> 3, run);
  }

 private:
  /// The open child's 4×4×4 parent voxels.
  void fill_octant(int octant) {
    const int base = 4 * (octant & 1) + 8 * 4 * (octant >> 1 & 1) + 64 * 4 * (octant >> 2);
    for (int z = 0; z < 4; ++z)
      for (int y = 0; y < 4; ++y) {
        const std::uint64_t low = open_.mask[2 * z] >> (16 * y), high = open_.mask[2 * z + 1] >> (16 * y);
        const std::uint64_t rows[4] = {low & 255, low >> 8 & 255, high & 255, high >> 8 & 255};
        if ((rows[0] | rows[1] | rows[2] | rows[3]) == 0) continue;
        fill_row(rows, &open_.voxel[64 * 2 * z + 8 * 2 * y], base + 8 * y + 64 * z);
      }
  }

  /// from: the child voxel (0, 2y, 2z); to: parent voxel (0, y, z) of this octant.
  void fill_row(const std::uint64_t rows[4], const Voxel* from, int to) {
    for (int x = 0; x < 4; ++x) {
      VoxelOctet octet;
      octet.present = present_octants(rows, x);
      if (octet.present == 0) continue;
      for (int c = 0; c < 8; ++c)
        if (octet.present >> c & 1) octet.child[c] = from[2 * x + (c & 1) + 8 * (c >> 1 & 1) + 64 * (c >> 2)];
      const int voxel = to + x;
      parent_[voxel] = mip(octet, filter_, tables_);
      mask_[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
    }
  }

  void pack(std::uint64_t key, BrickRun& run) {
    for (int word = 0; word < 8; ++word)
      for (std::uint64_t rest = mask_[word]; rest != 0; rest &= rest - 1)
        run.push_voxel(parent_[64 * word + std::countr_zero(rest)]);
    run.push_brick(key, mask_);
    for (std::uint64_t& word : mask_) word = 0;
  }

  const Level& fine_;
  MipFilter filter_;
  Tables tables_;
  OpenBrick open_;
  Voxel parent_[brick_voxels];
  std::uint64_t mask_[8] = {};
};

}  // namespace

Level coarser_level(const Level& fine, MipFilter filter, bool normals, const CpuPolicy& policy) {
  const std::vector<std::size_t> starts = parent_starts(fine);
  const std::size_t parents = starts.size() - 1;
  std::vector<BrickRun> runs((parents + parents_per_run - 1) / parents_per_run, BrickRun(normals));
  policy.parallel_for(parents, parents_per_run, [&](std::size_t begin, std::size_t end, int) {
    ParentBuilder builder(fine, filter);
    for (std::size_t p = begin; p < end; ++p) builder.build(starts[p], starts[p + 1], runs[p / parents_per_run]);
  });
  Level level;
  append(level, runs, policy);
  return level;
}

}  // namespace gigabake::kernels
