#include "kernels/cpu/levels.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "kernels/body/mip.h"
#include "kernels/cpu/brick_run.h"
#include "lattice/brick.h"
#include "lattice/rules.h"
#include "lattice/thread_pool.h"

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
  std::size_t index[brick_voxels];  ///< in the level
};

void open_brick(const Level& level, std::size_t brick, OpenBrick& out) {
  out.mask = &level.mask[8 * brick];
  std::size_t from = level.first[brick];
  for (int word = 0; word < 8; ++word)
    for (std::uint64_t rest = out.mask[word]; rest != 0; rest &= rest - 1, ++from) {
      const int at = 64 * word + std::countr_zero(rest);
      Voxel& v = out.voxel[at];
      for (int c = 0; c < 4; ++c) v.rgba[c] = level.rgba[4 * from + c];
      for (int c = 0; c < 2; ++c) v.normal[c] = level.normal.empty() ? std::int8_t(0) : level.normal[2 * from + c];
      out.index[at] = from;
    }
}

/// Which of the 2×2×2 voxels from (2x, 2y, 2z) exist, given the four rows (y, z) of 8 bits they stand in.
std::uint8_t present_octants(const std::uint64_t rows[4], int x) {
  std::uint64_t present = 0;
  for (int r = 0; r < 4; ++r) present |= (rows[r] >> (2 * x) & 3) << (2 * r);
  return std::uint8_t(present);
}

/// The 2×2×2 voxels below one, x | y<<1 | z<<2; null where there is none.
struct Children {
  const Voxel* voxel[8];
  std::size_t index[8];
};

/// What see_children() asks (kernels/body/facing.h).
struct ChildRasters {
  const Children& children;
  const std::uint32_t* rasters;  ///< of the level
  int edge;

  template <int N>
  CellRun<N> cells(int child, int axis, int run) const {
    CellRun<N> out = {};
    if (children.voxel[child] == nullptr) return out;
    const std::size_t at = children.index[child] * std::size_t(raster_words(edge));
    std::copy_n(rasters + at + axis * edge * edge / 4 + N * run, N, out.word);
    return out;
  }
};

FacingSums see(const Children& children, const std::uint32_t* rasters, int edge, std::uint32_t* raster) {
  const ChildRasters from{children, rasters, edge};
  if (edge == 2) return see_children<2>(from, raster);
  if (edge == 4) return see_children<4>(from, raster);
  if (edge == 8) return see_children<8>(from, raster);
  std::uint32_t coverage[2] = {};
  for (int c = 0; c < 8; ++c)
    if (children.voxel[c] != nullptr) coverage[c / 4] |= std::uint32_t(children.voxel[c]->rgba[3]) << 8 * (c % 4);
  return see_voxels(coverage[0], coverage[1], raster);
}

/// Consecutive bricks with what the level above needs of them.
struct LevelRun {
  BrickRun bricks;
  std::vector<std::uint32_t> rasters;
};

class ParentBuilder {
 public:
  /// rasters: of `fine`; empty at lod 0.
  ParentBuilder(const Level& fine, int lod, const LevelRasters& rasters, MipFilter filter)
      : fine_(fine),
        rasters_(rasters.data()),
        edge_(raster_edge(lod - 1)),
        raster_words_(raster_words(raster_edge(lod))),
        filter_(filter),
        tables_(TableStore::host().view()) {}

  /// children [begin, end) of `fine` share one parent.
  void build(std::size_t begin, std::size_t end, LevelRun& run) {
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
        fill_row(rows, 64 * 2 * z + 8 * 2 * y, base + 8 * y + 64 * z);
      }
  }

  /// from: the child voxel (0, 2y, 2z); to: parent voxel (0, y, z) of this octant.
  void fill_row(const std::uint64_t rows[4], int from, int to) {
    for (int x = 0; x < 4; ++x) {
      const std::uint8_t present = present_octants(rows, x);
      if (present == 0) continue;
      Children children;
      for (int c = 0; c < 8; ++c) {
        const int at = from + 2 * x + (c & 1) + 8 * (c >> 1 & 1) + 64 * (c >> 2);
        children.voxel[c] = (present >> c & 1) != 0 ? &open_.voxel[at] : nullptr;
        children.index[c] = open_.index[at];
      }
      const int voxel = to + x;
      mask_[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
      if (filter_ == MipFilter::coverage)
        filter_by_view(children, voxel);
      else
        filter_by_mean(children, voxel);
    }
  }

  void filter_by_view(const Children& children, int voxel) {
    const FacingSums seen = see(children, rasters_, edge_, raster_[voxel]);
    CoarseVoxel& out = parent_[voxel];
    for (int a = 0; a < 3; ++a) out.facing[a] = seen.facing(a, edge_);
    MipSums sums;
    for (int c = 0; c < 8; ++c)
      if (children.voxel[c] != nullptr) sums.add(*children.voxel[c], seen.weight(c, edge_), tables_);
    for (int c = 0; c < 8 && sums.weight == 0; ++c)  // too faint to be seen
      if (children.voxel[c] != nullptr) sums.add(*children.voxel[c], 1, tables_);
    out.voxel = sums.voxel(largest(out.facing), tables_);
  }

  void filter_by_mean(const Children& children, int voxel) {
    MipSums sums;
    for (const Voxel* child : children.voxel)
      if (child != nullptr) sums.add(*child, child->rgba[3], tables_);
    parent_[voxel].voxel = sums.voxel(mean_coverage(sums.weight, filter_, tables_), tables_);
  }

  void pack(std::uint64_t key, LevelRun& run) {
    for (int word = 0; word < 8; ++word)
      for (std::uint64_t rest = mask_[word]; rest != 0; rest &= rest - 1) {
        const int voxel = 64 * word + std::countr_zero(rest);
        run.bricks.push_voxel(parent_[voxel].voxel);
        if (filter_ != MipFilter::coverage) continue;
        run.bricks.push_facing(parent_[voxel].facing);
        run.rasters.insert(run.rasters.end(), raster_[voxel], raster_[voxel] + raster_words_);
      }
    run.bricks.push_brick(key, mask_);
    for (std::uint64_t& word : mask_) word = 0;
  }

  const Level& fine_;
  const std::uint32_t* rasters_;
  int edge_, raster_words_;
  MipFilter filter_;
  Tables tables_;
  OpenBrick open_;
  CoarseVoxel parent_[brick_voxels];
  std::uint32_t raster_[brick_voxels][raster_words(most_raster_edge)];
  std::uint64_t mask_[8] = {};
};

/// A level, and the rasters of its voxels where its filter needs them.
struct FilteredLevel {
  Level level;
  LevelRasters rasters;
};

void join_rasters(std::vector<LevelRun>& runs, const ThreadPool& pool, LevelRasters& rasters) {
  std::vector<std::size_t> at{0};
  for (const LevelRun& run : runs) at.push_back(at.back() + run.rasters.size());
  rasters.resize(at.back());
  pool.parallel_for(runs.size(), 4, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::copy(runs[r].rasters.begin(), runs[r].rasters.end(), rasters.begin() + std::ptrdiff_t(at[r]));
      runs[r].rasters = {};
    }
  });
}

FilteredLevel coarser_level(const Level& fine, int lod, const LevelRasters& rasters, MipFilter filter, bool normals,
                            const ThreadPool& pool) {
  const std::vector<std::size_t> starts = parent_starts(fine);
  const std::size_t parents = starts.size() - 1;
  std::vector<LevelRun> runs((parents + parents_per_run - 1) / parents_per_run, {BrickRun(normals), {}});
  pool.parallel_for(parents, parents_per_run, [&](std::size_t begin, std::size_t end, int) {
    const auto builder = std::make_unique<ParentBuilder>(fine, lod, rasters, filter);
    for (std::size_t p = begin; p < end; ++p) builder->build(starts[p], starts[p + 1], runs[p / parents_per_run]);
  });
  FilteredLevel out;
  join_rasters(runs, pool, out.rasters);
  std::vector<BrickRun> bricks;
  for (LevelRun& run : runs) bricks.push_back(std::move(run.bricks));
  append(out.level, bricks, pool);
  return out;
}

}  // namespace

void add_coarser_levels(std::vector<Level>& levels, LevelRasters& rasters, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool) {
  while (int(levels.size()) < lods) {
    FilteredLevel next = coarser_level(levels.back(), int(levels.size()), rasters, filter, normals, pool);
    levels.push_back(std::move(next.level));
    rasters = std::move(next.rasters);
  }
}

void drop_facing(std::vector<Level>& levels) {
  for (Level& level : levels) level.facing = {};
}

}  // namespace gigabake::kernels
