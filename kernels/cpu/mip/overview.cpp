#include "kernels/cpu/mip/overview.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <tuple>

#include "core/base/error.h"
#include "core/math/box3.h"
#include "core/octree/morton.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/prune/node.h"
#include "kernels/cpu/mip/downsample_state.h"
#include "kernels/cpu/mip/level_hash.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cpu/prune/prune.h"
#include "kernels/cpu/voxelize/brick_run.h"
#include "kernels/cpu/voxelize/quantize_groups.h"

namespace gigabake::kernels {
namespace {

/// A child's voxel and its position in the overview's window.
struct PlacedVoxel {
  std::uint64_t brick;  ///< Morton code of the brick
  std::uint32_t bit;    ///< x + 8y + 64z in the brick
  const DownsampleState* source;
  std::size_t row;
};

/// The voxels of all children on one level, inside the overview's window, in the order of a level.
class JoinedLevel {
 public:
  /// `below` is the number of levels from the children's coarsest level down to this level.
  JoinedLevel(std::span<const JoinedChild> children, const OverviewParameters& p, int below)
      : parameters_(p), below_(below), lod_(p.child_lod - below) {
    for (const JoinedChild& child : children) add(child);
    std::sort(voxels_.begin(), voxels_.end(), [](const PlacedVoxel& a, const PlacedVoxel& b) {
      return std::tie(a.brick, a.bit) < std::tie(b.brick, b.bit);
    });
    for (std::size_t i = 1; i < voxels_.size(); ++i)
      if (voxels_[i].brick == voxels_[i - 1].brick && voxels_[i].bit == voxels_[i - 1].bit)
        throw InputError("parent", "children", "two children have a voxel at the same position");
  }

  Level level(const ThreadPool& pool) const {
    BrickRun run(parameters_.normals);
    std::vector<Voxel> voxels;
    for (std::size_t i = 0; i < voxels_.size();) {
      const std::uint64_t brick = voxels_[i].brick;
      std::uint64_t mask[8] = {};
      voxels.clear();
      for (; i < voxels_.size() && voxels_[i].brick == brick; ++i) {
        mask[voxels_[i].bit >> 6] |= std::uint64_t(1) << (voxels_[i].bit & 63);
        voxels.push_back(voxel(voxels_[i]));
      }
      run.push_brick(brick, mask, voxels);
    }
    Level level;
    std::vector<BrickRun> runs{std::move(run)};
    append(level, runs, pool);
    for (const PlacedVoxel& v : voxels_)
      if (parameters_.classes) level.voxel_class.push_back(v.source->voxel_class[v.row]);
    return level;
  }

  /// Returns the coverage masks and patches of the voxels. Level 0 has no coverage masks, and no patches if its voxels
  /// have no planes.
  LevelSurface surface() const {
    LevelSurface surface;
    if (!filters_by_view(parameters_.mip)) return surface;
    const std::size_t bytes = raster_bytes(lod_), words = bytes / sizeof(std::uint32_t);
    surface.rasters.resize(words * voxels_.size());
    surface.patches.resize(parameters_.normals ? voxels_.size() : 0, patch_without_plane());
    for (std::size_t i = 0; i < voxels_.size(); ++i) {
      const PlacedVoxel& v = voxels_[i];
      std::copy_n(v.source->raster.data() + bytes * v.row, bytes,
                  reinterpret_cast<std::uint8_t*>(surface.rasters.data() + words * i));
      if (!v.source->patch.empty())
        std::memcpy(&surface.patches[i], &v.source->patch[source_patch_bytes * v.row], source_patch_bytes);
    }
    return surface;
  }

 private:
  void add(const JoinedChild& child) {
    const Vec3i64 corner = (child.lattice_min - parameters_.window_min) >> lod_;
    const auto window = Box3i64::cube({}, std::int64_t(brick_edge) << (parameters_.levels + below_));
    for (std::size_t row = 0; row < child.source->voxels(); ++row) {
      const std::uint8_t* place = &child.source->place[source_place_bytes * row];
      if (int(place[0]) != below_) continue;
      const Vec3i64 at = corner + Vec3i64{place[1], place[2], place[3]};
      if (!window.contains(at)) continue;
      voxels_.push_back({morton(std::uint32_t(at[0] >> 3), std::uint32_t(at[1] >> 3), std::uint32_t(at[2] >> 3)),
                         std::uint32_t((at[0] & 7) + 8 * (at[1] & 7) + 64 * (at[2] & 7)), child.source, row});
    }
  }

  Voxel voxel(const PlacedVoxel& v) const {
    Voxel out{};
    std::copy_n(&v.source->rgba[4 * v.row], 4, out.rgba);
    if (parameters_.normals) std::copy_n(&v.source->normal[2 * v.row], 2, out.normal);
    return out;
  }

  const OverviewParameters& parameters_;
  const int below_, lod_;
  std::vector<PlacedVoxel> voxels_;
};

void expect_columns(const DownsampleState& s, const OverviewParameters& p) {
  const auto expect = [](bool holds) {
    if (!holds)
      throw InputError("parent", "children", "columns of a child do not match each other or the rules of an overview");
  };
  const std::size_t voxels = s.voxels();
  expect(s.place.size() == source_place_bytes * voxels && s.rgba.size() == 4 * voxels);
  std::size_t coarsest = 0;
  while (coarsest < voxels && s.place[source_place_bytes * coarsest] == 0) ++coarsest;
  const bool by_view = filters_by_view(p.mip);
  expect(s.normal.size() == (p.normals ? 2 * voxels : 0));
  expect(s.raster.size() == (by_view ? raster_bytes(p.child_lod) * coarsest : 0));
  expect(s.voxel_class.size() == (p.classes ? voxels : 0));
  const bool finest_without_planes = p.child_lod == 0 && s.patch.empty();
  expect(s.patch.size() == (by_view && p.normals && !finest_without_planes ? source_patch_bytes * coarsest : 0));
  expect((coarsest < voxels) == (voxels > 0 && is_of_64(p.mip, p.child_lod + 1)));
}

/// Returns levels 0 to p.child_lod of the lattice. The last level joins the children's coarsest levels over the window.
/// Finer levels are empty unless the filter reads them.
std::vector<Level> joined_levels(std::span<const JoinedChild> children, const OverviewParameters& p,
                                 const ThreadPool& pool, LevelSurface& surface) {
  std::vector<Level> levels(std::size_t(p.child_lod) + 1);
  const JoinedLevel coarsest(children, p, 0);
  levels.back() = coarsest.level(pool);
  surface = coarsest.surface();
  if (is_of_64(p.mip, p.child_lod + 1)) levels[levels.size() - 2] = JoinedLevel(children, p, 1).level(pool);
  return levels;
}

/// Checks that each brick has a parent brick in the next coarser level, because the parents' nodes link to their
/// children.
void expect_tree(const std::vector<Level>& levels) {
  for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
    const std::vector<std::uint64_t>& above = levels[l + 1].key;
    for (std::size_t b = 0, at = 0; b < levels[l].key.size(); ++b) {
      while (at < above.size() && above[at] < parent_key(levels[l].key[b])) ++at;
      if (at == above.size() || above[at] != parent_key(levels[l].key[b]))
        throw InputError("parent", "children", "a level of a child has voxels where the next coarser level has none");
    }
  }
}

}  // namespace

CellVolume bake_overview(std::span<const JoinedChild> children, const OverviewParameters& p, const ThreadPool& pool,
                         std::vector<Level> copies) {
  for (const JoinedChild& child : children) expect_columns(*child.source, p);
  CellVolume volume;
  LevelSurface surface;
  std::vector<Level> levels = joined_levels(children, p, pool, surface);
  if (levels.back().key.empty()) return volume;
  const int own_lod = p.child_lod + 1, lods = own_lod + p.levels, first_lod = own_lod - int(copies.size());
  add_coarser_levels(levels, surface, lods, p.mip, p.normals, pool);
  volume.above = downsample_state(levels, lods - 1, surface, p.mip);
  levels.erase(levels.begin(), levels.begin() + own_lod);
  if (!p.directional_coverage) drop_directional_coverage(levels);
  quantize_groups(levels, p.max_error, pool);
  levels.insert(levels.begin(), std::move_iterator(copies.begin()), std::move_iterator(copies.end()));
  expect_tree(levels);
  for (const Level& level : levels)
    volume.content_hash.push_back(level_hash(level, first_lod + int(volume.content_hash.size()), p.window_min, pool));
  volume.nodes = brick_nodes(levels);
  volume.levels = std::move(levels);
  return volume;
}

}  // namespace gigabake::kernels
