#include "viewer/stream/brick_fill.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "core/math/box3.h"
#include "core/octree/plane_in_part.h"

namespace gigabake {
namespace {

using kernels::CastBrick;
using kernels::slot_edge;
using kernels::VoxelBox;
using kernels::VoxelRun;

/// A box of voxels in a slot.
using SlotPart = Box3<int>;

/// A list of the runs of one brick, without allocations.
class RunList {
 public:
  void push_back(const VoxelRun& run) { runs_[count_++] = run; }
  void clear() { count_ = 0; }
  const VoxelRun* begin() const { return runs_; }
  const VoxelRun* end() const { return runs_ + count_; }

 private:
  std::size_t count_ = 0;
  VoxelRun runs_[kernels::slot_voxels];  ///< each run has at least one voxel
};

class BrickFiller {
 public:
  BrickFiller(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup, const Shading& shading,
              NodePath& path, MissingPages& missing_pages, CastBrick& brick, BrickPages& pages)
      : lod_(node.lod),
        top_(layout.scene.lods - 1),
        corner_(box_of(node, layout)),
        lookup_(lookup),
        shading_(shading.parameters()),
        gaps_(missing_pages),
        brick_(brick),
        pages_(pages),
        path_(path) {}

  /// Fills the brick's own voxels, then the border from the neighbours at three faces, three edges and one corner.
  bool fill() {
    for (int side = 0; side < 8; ++side) {
      SlotPart part;
      for (int a = 0; a < 3; ++a) {
        part.min[a] = (side >> a & 1) != 0 ? brick_edge : 0;
        part.end[a] = (side >> a & 1) != 0 ? slot_edge : brick_edge;
      }
      fill_part(part);
    }
    brick_.lod = lod_;
    if (has_own_voxels_) {
      for (const VoxelRun& run : runs_) expand(run);
      kernels::pack_brick(slot_, brick_);
    } else {
      kernels::pack_layers(slot_, brick_);
      brick_.runs.assign(runs_.begin(), runs_.end());
    }
    return brick_.part_count != 0;
  }

 private:
  std::int64_t lattice(int a, int slot) const { return corner_.min[a] + (std::int64_t(slot) << lod_); }

  /// Fills the voxels of `part` that one stored brick covers, then recurses into the up to three boxes that remain. A
  /// part may need several stored bricks. Bricks of cells may begin at any z, and bricks of a root overview may begin
  /// in the middle of a node.
  void fill_part(const SlotPart& part) {
    // A cell may be offset along z by a fraction of a voxel. Use the cell's voxel that contains the centre of the
    // slot's voxel.
    const std::int64_t half = std::int64_t(1) << lod_ >> 1;
    const Vec3i64 v{lattice(0, part.min[0]), lattice(1, part.min[1]), lattice(2, part.min[2]) + half};
    const VoxelPlace place = lookup_.place(lod_, v, gaps_, path_);
    SlotPart first = part;
    for (int a = 0; a < 3; ++a) {
      const std::int64_t centre = a == 2 ? half : 0;
      first.end[a] = part.min[a] + 1;
      while (first.end[a] < part.end[a] && lattice(a, first.end[a]) + centre < place.box.max[a]) ++first.end[a];
    }
    if (place.kind == VoxelPlace::Kind::constant) fill_constant(first, place);
    if (place.kind == VoxelPlace::Kind::brick) fill_from_brick(first, place, half);
    if (place.kind == VoxelPlace::Kind::leaf) fill_from_leaf(first, half, place.leaf_lod);
    if (place.kind == VoxelPlace::Kind::unreadable && !gaps_.damaged) fill_from_coarser(first, half);
    SlotPart rest = part;
    for (int a = 0; a < 3; ++a) {
      rest.min[a] = first.end[a];
      if (rest.min[a] < rest.end[a]) fill_part(rest);
      rest.min[a] = first.min[a];
      rest.end[a] = first.end[a];
    }
  }

  /// Sets a voxel that the brick stores, in place of a run.
  void put(int x, int y, int z, const kernels::PackedVoxel& voxel) {
    has_own_voxels_ = true;
    slot_.voxel[x + slot_edge * (y + slot_edge * z)] = voxel;
    slot_.row[z][y] = std::uint16_t(slot_.row[z][y] | 1u << x);
  }

  /// Fills a part of the border whose data cannot be read. Uses the coarser voxels that are rendered in place of this
  /// data.
  void fill_from_coarser(const SlotPart& part, std::int64_t half) {
    for (int z = part.min[2]; z < part.end[2]; ++z)
      for (int y = part.min[1]; y < part.end[1]; ++y)
        for (int x = part.min[0]; x < part.end[0]; ++x) {
          const Vec3i64 v{lattice(0, x), lattice(1, y), lattice(2, z) + half};
          if (const auto voxel = coarser_voxel(v)) put(x, y, z, kernels::pack_voxel(*voxel));
        }
  }

  /// Returns the voxel at v of the finest readable coarser level. Clears its plane, because the plane describes a
  /// larger voxel.
  std::optional<kernels::CastVoxel> coarser_voxel(const Vec3i64& v) {
    for (int lod = lod_ + 1; lod <= top_; ++lod) {
      MissingPages missing_pages;
      const VoxelPlace place = lookup_.place(lod, v, missing_pages, path_);
      gaps_.missing.insert(gaps_.missing.end(), missing_pages.missing.begin(), missing_pages.missing.end());
      if (place.kind == VoxelPlace::Kind::unreadable) continue;
      auto voxel = voxel_at(place, lod, v);
      if (voxel) voxel->plane = 0;
      return voxel;
    }
    return {};
  }

  /// Fills a part of the border that leaves of level `leaf_lod` describe. Uses a leaf's values where its plane passes,
  /// or everywhere if it has none.
  void fill_from_leaf(const SlotPart& part, std::int64_t half, int leaf_lod) {
    for (int z = part.min[2]; z < part.end[2]; ++z)
      for (int y = part.min[1]; y < part.end[1]; ++y)
        for (int x = part.min[0]; x < part.end[0]; ++x) {
          const Vec3i64 v{lattice(0, x), lattice(1, y), lattice(2, z) + half};
          const VoxelPlace place = lookup_.place(leaf_lod, v, gaps_, path_);
          auto voxel = voxel_at(place, leaf_lod, v);
          if (!voxel) continue;
          const Vec3i64 in_leaf = (v >> lod_ << lod_) - (v >> leaf_lod << leaf_lod);
          if (is_fully_planar(voxel->plane)) {
            const std::optional<std::uint8_t> plane =
                plane_in_part(voxel->plane, Vec3<std::int32_t>(voxel->normal), in_leaf >> lod_, leaf_lod - lod_);
            if (!plane) continue;
            voxel->plane = *plane;
          } else {
            voxel->plane = 0;
          }
          put(x, y, z, kernels::pack_voxel(*voxel));
        }
  }

  std::optional<kernels::CastVoxel> voxel_at(const VoxelPlace& place, int lod, const Vec3i64& v) const {
    if (place.kind == VoxelPlace::Kind::constant) return kernels::unpack_voxel(constant_voxel(place, lod));
    if (place.kind != VoxelPlace::Kind::brick) return {};
    const auto at = static_cast<Vec3<int>>((v - place.box.min) >> lod);
    const std::uint64_t* mask = &place.page->bricks.mask[8 * place.brick];
    const int bit = at[0] + 8 * at[1];
    if ((mask[at[2]] >> bit & 1) == 0) return {};
    std::uint32_t rank = place.page->bricks.first[place.brick];
    for (int z = 0; z < at[2]; ++z) rank += std::uint32_t(std::popcount(mask[z]));
    rank += std::uint32_t(std::popcount(mask[at[2]] & ((std::uint64_t(1) << bit) - 1)));
    return kernels::unpack_voxel(kernels::shaded_voxel(shading_, lod, voxels_of(*place.page), rank));
  }

  kernels::PackedVoxel constant_voxel(const VoxelPlace& place, int lod) const {
    const kernels::StoredVoxels voxel{place.rgba.data(), place.normal.data(),
                                      place.has_directional_coverage ? place.directional_coverage.data() : nullptr,
                                      &place.voxel_class};
    return kernels::shaded_voxel(shading_, lod, voxel, 0);
  }

  void fill_constant(const SlotPart& part, const VoxelPlace& place) {
    const kernels::PackedVoxel voxel = constant_voxel(place, lod_);
    for (int z = part.min[2]; z < part.end[2]; ++z)
      for (int y = part.min[1]; y < part.end[1]; ++y)
        for (int x = part.min[0]; x < part.end[0]; ++x) put(x, y, z, voxel);
  }

  void fill_from_brick(const SlotPart& part, const VoxelPlace& place, std::int64_t half) {
    const std::uint64_t* mask = &place.page->bricks.mask[8 * place.brick];
    Vec3<int> from;
    for (int a = 0; a < 3; ++a)
      from[a] = int((lattice(a, part.min[a]) + (a == 2 ? half : 0) - place.box.min[a]) >> lod_);
    const std::uint8_t page = number_of(*place.page);
    const int width = part.end[0] - part.min[0];
    std::uint32_t before = place.page->bricks.first[place.brick];
    for (int z = 0; z < from[2]; ++z) before += std::uint32_t(std::popcount(mask[z]));
    for (int z = part.min[2]; z < part.end[2]; ++z) {
      const std::uint64_t word = mask[from[2] + z - part.min[2]];
      for (int y = part.min[1]; y < part.end[1]; ++y) {
        const int bit = 8 * (from[1] + y - part.min[1]) + from[0];
        const std::uint32_t row = std::uint32_t(word >> bit) & ((1u << width) - 1);
        if (row == 0) continue;
        const std::uint32_t rank = before + std::uint32_t(std::popcount(word & ((std::uint64_t(1) << bit) - 1)));
        add_run(part.min[0], y, z, row, rank, page);
      }
      before += std::uint32_t(std::popcount(word));
    }
  }

  /// Adds the voxels `row` of a row of the slot; bit 0 is the voxel at x. `rank` is the index of the first one in the
  /// page.
  void add_run(int x, int y, int z, std::uint32_t row, std::uint32_t rank, std::uint8_t page) {
    slot_.row[z][y] = std::uint16_t(slot_.row[z][y] | row << x);
    const int first = x + std::countr_zero(row);
    runs_.push_back(
        {rank, std::uint16_t(first + slot_edge * (y + slot_edge * z)), std::uint8_t(std::popcount(row)), page});
  }

  /// Returns the page's index in pages_. If they are full, replaces all runs with voxels first.
  std::uint8_t number_of(const Page& page) {
    for (std::uint8_t i = 0; i < page_count_; ++i)
      if (pages_[i] == &page) return i;
    if (page_count_ == kernels::max_brick_pages) {
      for (const VoxelRun& run : runs_) expand(run);
      runs_.clear();
      page_count_ = 0;
    }
    pages_[page_count_] = &page;
    return page_count_++;
  }

  /// Sets the voxels of a run.
  void expand(const VoxelRun& run) {
    const kernels::StoredVoxels voxels = voxels_of(*pages_[run.page]);
    const int x0 = run.place % slot_edge, y = run.place / slot_edge % slot_edge, z = run.place / slot_edge / slot_edge;
    std::uint32_t row = std::uint32_t(slot_.row[z][y]) >> x0 << x0;
    for (std::uint32_t k = 0; k < run.count; ++k, row &= row - 1)
      put(std::countr_zero(row), y, z, kernels::shaded_voxel(shading_, lod_, voxels, run.from + k));
  }

  int lod_, top_;
  VoxelBox corner_;
  const VoxelLookup& lookup_;
  const kernels::StoredVoxelShading& shading_;
  MissingPages& gaps_;
  CastBrick& brick_;
  BrickPages& pages_;
  NodePath& path_;
  std::uint8_t page_count_ = 0;
  bool has_own_voxels_ = false;
  RunList runs_;
  kernels::SlotVoxels slot_;
};

}  // namespace

VoxelBox box_of(const FieldNode& node, const CellLayout& layout) {
  const Vec3i64 min = layout.cells[node.cell].min + (static_cast<Vec3i64>(node.at) << (node.lod + 3));
  return {min, min + Vec3i64::all(std::int64_t(brick_edge) << node.lod)};
}

ChildMasks children_of(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup,
                       MissingPages& missing_pages) {
  const int lod = node.lod - 1;
  VoxelLookup::Boxes own, boxes;
  for (unsigned octant = 0; octant < 8; ++octant) {
    own[octant] = boxes[octant] = box_of(node.child(octant), layout);
    for (std::int64_t& side : boxes[octant].max) side += std::int64_t(1) << lod;
  }
  ChildMasks children{lookup.occupied(lod, boxes, missing_pages), 0};
  if (lod >= layout.leaf_lod) return children;
  children.leaves = lookup.leaves(lod, own, missing_pages);
  children.stored |= lookup.leaves(lod, boxes, missing_pages);
  children.stored = std::uint8_t(children.stored & ~unsigned(children.leaves));
  return children;
}

bool fill_brick(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup, const Shading& shading,
                NodePath& path, MissingPages& missing_pages, CastBrick& brick, BrickPages& pages) {
  return BrickFiller(node, layout, lookup, shading, path, missing_pages, brick, pages).fill();
}

kernels::StoredVoxels voxels_of(const Page& page) {
  const BrickBlock& bricks = page.bricks;
  const auto column = [](const auto& values) { return values.empty() ? nullptr : values.data(); };
  return {bricks.rgba.data(), column(bricks.normal), column(bricks.directional_coverage), column(bricks.voxel_class)};
}

void copy_runs(const Shading& shading, const BrickPages& pages, CastBrick& brick) {
  if (brick.runs.empty()) return;
  std::array<kernels::StoredVoxels, kernels::max_brick_pages> columns;
  for (std::size_t i = 0; i < pages.size() && pages[i] != nullptr; ++i) columns[i] = voxels_of(*pages[i]);
  kernels::copy_runs(shading.parameters(), columns, brick);
}

}  // namespace gigabake
