#include "kernels/cpu/mip/levels.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <span>

#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "core/octree/brick.h"
#include "kernels/body/mask.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/mip/plane_fit.h"
#include "kernels/body/prune/node.h"
#include "kernels/body/voxel_class.h"
#include "kernels/cpu/mip/leaves.h"
#include "kernels/cpu/mip/level_read.h"
#include "kernels/cpu/mip/two_level_filter.h"
#include "kernels/cpu/voxelize/brick_run.h"

namespace gigabake::kernels {
namespace {

/// The voxels of a brick, indexed by x + 8y + 64z. Entries without a mask bit are stale.
struct OpenBrick {
  const std::uint64_t* mask;
  Voxel voxel[brick_voxels];
  std::size_t index[brick_voxels];  ///< index of the voxel in the level
};

void open_brick(const Level& level, std::size_t brick, OpenBrick& out) {
  out.mask = &level.mask[8 * brick];
  std::size_t from = level.first[brick];
  for (int word = 0; word < 8; ++word)
    for (std::uint64_t rest = out.mask[word]; rest != 0; rest &= rest - 1, ++from) {
      const int at = 64 * word + std::countr_zero(rest);
      out.voxel[at] = voxel_at(level, from);
      out.index[at] = from;
    }
}

/// The 2×2×2 children of a voxel, numbered x | y<<1 | z<<2.
struct Children {
  Voxel voxel[8];  ///< zero if the child does not exist
  std::size_t index[8];
  std::uint32_t there[2] = {};  ///< byte c: 1 if child c exists

  bool has(int c) const { return (there[c / 4] >> 8 * (c % 4) & 1) != 0; }
};

/// The accessor to the coverage masks of children that cover_children() requires
/// (kernels/body/mip/directional_coverage.h).
template <int Edge>
struct ChildRasters {
  const Children& children;
  const std::uint32_t* rasters;  ///< coverage masks of all voxels of the children's level

  template <int N>
  CellRun<N> cells(int child, int axis, int run) const {
    CellRun<N> out = {};
    if (!children.has(child)) return out;
    const std::size_t at = children.index[child] * std::size_t(raster_words(Edge));
    std::copy_n(rasters + at + axis * Edge * Edge / 4 + N * run, N, out.word);
    return out;
  }
};

Weights see_finest(const Children& children, bool has_normals, const Tables& tables, std::uint32_t* raster) {
  AxisCoverage all;
  GB_UNROLL_ALWAYS
  for (int c = 0; c < 8; ++c)
    if (children.has(c)) all.add(c, coverage_of_finest(children.voxel[c], has_normals, tables));
  return weights_of(see_voxels(all, raster), 1, children.there);
}

/// Computes the coverage of a voxel from its children's masks with Edge cells along an edge. The constant edge makes
/// the divisions of weights_of() cheap.
template <int Edge>
Weights see(const Children& children, const std::uint32_t* rasters, std::uint32_t* raster) {
  return weights_of(cover_children<Edge>(ChildRasters<Edge>{children, rasters}, raster), Edge, children.there);
}

/// Computes the coverage of a voxel from the coverage masks of its children. `edge` is the edge of the children's masks
/// in cells.
/// Range   The children are not of lod 0.
Weights see(const Children& children, const std::uint32_t* rasters, int edge, std::uint32_t* raster) {
  if (edge == 2) return see<2>(children, rasters, raster);
  return edge == 4 ? see<4>(children, rasters, raster) : see<8>(children, rasters, raster);
}

/// Consecutive bricks with the surface data that the next coarser level needs.
struct LevelRun {
  BrickRun bricks;
  LevelSurface surface;
};

class ParentBuilder {
 public:
  /// `surface` is the surface data of `fine`. If `fine` is lod 0, it has at most patches, in place of planes in `fine`.
  ParentBuilder(const Level& fine, int lod, const LevelSurface& surface, MipFilter filter)
      : fine_(fine),
        surface_(surface),
        has_planes_(!fine.normal.empty()),
        edge_(raster_edge(lod - 1)),
        raster_words_(raster_words(raster_edge(lod))),
        filter_(filter),
        tables_(TableStore::host().view()) {}

  /// Builds the parent brick of bricks [begin, end) of `fine` and appends it to `run`.
  void build(std::size_t begin, std::size_t end, LevelRun& run) {
    for (std::size_t child = begin; child < end; ++child) {
      open_brick(fine_, child, open_);
      fill_octant(octant_of(fine_.key[child]));
    }
    pack(parent_key(fine_.key[begin]), run);
  }

 private:
  /// Tests whether `fine` is lod 0.
  bool is_finest() const { return edge_ == 1; }

  /// Computes the 4×4×4 voxels of the parent brick that the open child brick covers.
  void fill_octant(int octant) {
    const int base = 4 * (octant & 1) + 8 * 4 * (octant >> 1 & 1) + 64 * 4 * (octant >> 2);
    for (int z = 0; z < 4; ++z)
      for (std::uint64_t rest = parent_slab(open_.mask[2 * z], open_.mask[2 * z + 1]); rest != 0; rest &= rest - 1) {
        const int at = std::countr_zero(rest);  // x + 8y
        filter(2 * (at & 7) + 16 * (at >> 3) + 128 * z, base + at + 64 * z);
      }
  }

  /// Filters 2×2×2 voxels of the open child brick to one voxel of the parent brick. `from` is the position of the
  /// lowest of the eight voxels, and `to` is the position in the parent.
  void filter(int from, int to) {
    Children children;
    GB_UNROLL_ALWAYS
    for (int c = 0; c < 8; ++c) {
      const int at = from + (c & 1) + 8 * (c >> 1 & 1) + 64 * (c >> 2);
      const bool there = (open_.mask[at >> 6] >> (at & 63) & 1) != 0;
      children.there[c / 4] |= std::uint32_t(there) << 8 * (c % 4);
      children.voxel[c] = there ? open_.voxel[at] : Voxel{};
      children.index[c] = open_.index[at];
    }
    mask_[to >> 6] |= std::uint64_t(1) << (to & 63);
    if (filters_by_view(filter_)) {
      weights_[to] = is_finest() ? see_finest(children, has_planes_, tables_, raster_[to])
                                 : see(children, surface_.rasters.data(), edge_, raster_[to]);
      if (has_planes_)
        filter_patch(children, to);
      else
        parent_[to] = filter_children<true>(children.voxel, weights_[to], filter_, tables_);
    } else {
      parent_[to] = filter_children<false>(children.voxel, {}, filter_, tables_);
    }
    if (!fine_.voxel_class.empty()) class_[to] = class_of(children, to);
  }

  VoxelClass class_of(const Children& children, int to) const {
    VoxelClass classes[8] = {};
    std::uint32_t weights[8] = {};
    for (int c = 0; c < 8; ++c) {
      if (!children.has(c)) continue;
      classes[c] = fine_.voxel_class[children.index[c]];
      weights[c] = filters_by_view(filter_) ? weights_[to].of(c) : children.voxel[c].rgba[3];
    }
    return class_of_children(classes, weights);
  }

  void filter_patch(const Children& children, int to) {
    const auto patch = [&](int c, const UnitNormal& n) {
      const std::size_t i = children.index[c];
      return surface_.patches.empty() ? finest_patch_at(fine_, i, n) : surface_.patches[i];
    };
    const VoxelPatch made = filter_patches(children.voxel, patch, weights_[to], is_finest(), tables_);
    parent_[to] = made.voxel;
    patch_[to] = made.patch;
  }

  void put_directional_coverage(int voxel, std::uint8_t directional_coverage[directional_coverage_bytes]) const {
    const std::uint32_t all = weights_[voxel].directional_coverage;
    const Plane plane = has_planes_ ? plane_of(patch_[voxel], parent_[voxel].normal, is_finest()) : Plane();
    const std::uint32_t coverage = stored_coverage(plane, all);
    for (std::size_t axis = 0; axis < coverage_bytes; ++axis) directional_coverage[axis] = byte_of(coverage, int(axis));
    directional_coverage[directional_coverage_plane] = pack_plane(plane);
  }

  void pack(std::uint64_t key, LevelRun& run) {
    std::size_t count = 0;
    for (int word = 0; word < 8; ++word)
      for (std::uint64_t rest = mask_[word]; rest != 0; rest &= rest - 1)
        packed_[count++] = std::uint16_t(64 * word + std::countr_zero(rest));
    const std::span<const std::uint16_t> voxels(packed_, count);
    for (std::size_t i = 0; i < count; ++i) packed_voxel_[i] = parent_[voxels[i]];
    run.bricks.push_brick(key, mask_, {packed_voxel_, count});
    if (!fine_.voxel_class.empty()) {
      VoxelClass classes[brick_voxels];
      for (std::size_t i = 0; i < count; ++i) classes[i] = class_[voxels[i]];
      run.bricks.push_classes({classes, count});
    }
    if (filters_by_view(filter_)) pack_views(voxels, run);
    for (std::uint64_t& word : mask_) word = 0;
  }

  void pack_views(std::span<const std::uint16_t> voxels, LevelRun& run) {
    std::vector<std::uint32_t>& rasters = run.surface.rasters;
    const std::size_t words = std::size_t(raster_words_), before = rasters.size();
    std::uint8_t directional_coverage[directional_coverage_bytes * brick_voxels];
    rasters.resize(before + words * voxels.size());
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      put_directional_coverage(voxels[i], directional_coverage + directional_coverage_bytes * i);
      std::copy_n(raster_[voxels[i]], words, rasters.begin() + std::ptrdiff_t(before + words * i));
      if (has_planes_) run.surface.patches.push_back(patch_[voxels[i]]);
    }
    run.bricks.push_directional_coverage({directional_coverage, directional_coverage_bytes * voxels.size()});
  }

  const Level& fine_;
  const LevelSurface& surface_;
  bool has_planes_;
  int edge_, raster_words_;
  MipFilter filter_;
  Tables tables_;
  OpenBrick open_;
  Voxel parent_[brick_voxels];
  Weights weights_[brick_voxels];  ///< used only with MipFilter::coverage
  std::uint32_t raster_[brick_voxels][raster_words(max_raster_edge)];
  SurfaceMoments patch_[brick_voxels];  ///< used only with MipFilter::coverage and normals
  VoxelClass class_[brick_voxels];      ///< used only with classes
  std::uint64_t mask_[8] = {};
  std::uint16_t packed_[brick_voxels];  ///< positions of the parent's voxels, in ascending order
  Voxel packed_voxel_[brick_voxels];
};

/// A level, and the surface data that the next coarser level needs.
struct FilteredLevel {
  Level level;
  LevelSurface surface;
};

/// Concatenates one surface array of all runs and empties it in the runs. `of` is the array's member.
template <class Item>
void join(std::vector<LevelRun>& runs, std::vector<Item> LevelSurface::*of, const ThreadPool& pool,
          std::vector<Item>& all) {
  std::vector<std::size_t> at{0};
  for (const LevelRun& run : runs) at.push_back(at.back() + (run.surface.*of).size());
  all.resize(at.back());
  pool.parallel_for(runs.size(), 4, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::vector<Item>& part = runs[r].surface.*of;
      std::copy(part.begin(), part.end(), all.begin() + std::ptrdiff_t(at[r]));
      part = {};
    }
  });
}

FilteredLevel coarser_level(const Level& fine, int lod, const LevelSurface& surface, MipFilter filter, bool normals,
                            const ThreadPool& pool) {
  const std::vector<std::size_t> starts = starts_below(fine, parent_key);
  const std::size_t parents = starts.size() - 1;
  std::vector<LevelRun> runs((parents + bricks_per_run - 1) / bricks_per_run, {BrickRun(normals), {}});
  std::vector<std::unique_ptr<ParentBuilder>> builders(std::size_t(pool.threads()));
  pool.parallel_for(parents, bricks_per_run, [&](std::size_t begin, std::size_t end, int thread) {
    auto& builder = builders[std::size_t(thread)];
    if (!builder) builder = std::make_unique<ParentBuilder>(fine, lod, surface, filter);
    for (std::size_t p = begin; p < end; ++p) builder->build(starts[p], starts[p + 1], runs[p / bricks_per_run]);
  });
  FilteredLevel out;
  join(runs, &LevelSurface::rasters, pool, out.surface.rasters);
  join(runs, &LevelSurface::patches, pool, out.surface.patches);
  std::vector<BrickRun> bricks;
  for (LevelRun& run : runs) bricks.push_back(std::move(run.bricks));
  append(out.level, bricks, pool);
  return out;
}

}  // namespace

void add_coarser_levels(std::vector<Level>& levels, LevelSurface& surface, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool, std::span<const Level> leaves) {
  while (int(levels.size()) < lods) {
    const int lod = int(levels.size());
    if (is_of_64(filter, lod)) {
      levels.push_back(two_level_filtered_level(levels[std::size_t(lod) - 2], normals, pool));
      continue;
    }
    FilteredLevel next = coarser_level(levels.back(), lod, surface, filter, normals, pool);
    levels.push_back(std::move(next.level));
    surface = std::move(next.surface);
    if (std::size_t(lod) < leaves.size()) add_leaves(levels.back(), surface, leaves[std::size_t(lod)], lod, filter);
  }
}

void drop_directional_coverage(std::vector<Level>& levels) {
  for (Level& level : levels) level.directional_coverage = {};
}

}  // namespace gigabake::kernels
