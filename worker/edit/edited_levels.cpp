#include "worker/edit/edited_levels.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "core/octree/morton.h"
#include "kernels/cpu/mip/downsample_state.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cpu/voxelize/clip.h"
#include "worker/edit/level_bricks.h"

namespace gigabake {
namespace {

using kernels::Level;

/// Returns the keys of bricks that differ between two levels, ascending.
std::vector<std::uint64_t> changed_keys(const Level& before, const Level& after) {
  std::vector<std::uint64_t> all;
  std::set_union(before.key.begin(), before.key.end(), after.key.begin(), after.key.end(), std::back_inserter(all));
  std::erase_if(all, [&](std::uint64_t key) {
    const std::size_t a = find_brick(before, key), b = find_brick(after, key);
    return a < before.key.size() && b < after.key.size() && are_equal_bricks(before, a, after, b);
  });
  return all;
}

/// Returns the bricks with these keys.
Level bricks_of(const Level& level, std::span<const std::uint64_t> keys) {
  Level out;
  out.first = {0};
  for (const std::uint64_t key : keys)
    if (const std::size_t b = find_brick(level, key); b < level.key.size()) append_bricks(level, b, b + 1, out);
  return out;
}

/// The voxels of a brick that are inside the cubes.
BrickMask mask_in(const EditedCubes& cubes, int lod, std::uint64_t key) {
  const BrickCoordinate brick = demorton(key);
  BrickMask mask{};
  for (std::uint32_t v = 0; v < brick_voxels; ++v) {
    const Vec3<std::uint32_t> voxel{brick_edge * brick.x + v % 8, brick_edge * brick.y + v / 8 % 8,
                                    brick_edge * brick.z + v / 64};
    if (cubes.contains(lod, voxel)) mask[v / 64] |= std::uint64_t(1) << v % 64;
  }
  return mask;
}

/// Appends a brick with the voxels of `inside` that are in `mask`, and the voxels of `outside` that are not.
void append_joined(const Level& outside, const Level& inside, const BrickMask& mask, std::uint64_t key, Level& to) {
  const std::size_t out = find_brick(outside, key), in = find_brick(inside, key);
  const bool has_out = out < outside.key.size(), has_in = in < inside.key.size();
  std::size_t at_out = has_out ? outside.first[out] : 0, at_in = has_in ? inside.first[in] : 0, voxels = 0;
  BrickMask joined{};
  for (std::size_t w = 0; w < joined.size(); ++w) {
    const std::uint64_t of_out = has_out ? outside.mask[8 * out + w] : 0, of_in = has_in ? inside.mask[8 * in + w] : 0;
    joined[w] = (of_out & ~mask[w]) | (of_in & mask[w]);
    for (std::uint64_t left = of_out | of_in; left != 0; left &= left - 1) {
      const std::uint64_t bit = left & (~left + 1);
      if ((bit & joined[w] & mask[w]) != 0) append_voxel(inside, at_in, to);
      if ((bit & joined[w] & ~mask[w]) != 0) append_voxel(outside, at_out, to);
      at_in += (bit & of_in) != 0 ? 1 : 0;
      at_out += (bit & of_out) != 0 ? 1 : 0;
    }
    voxels += std::size_t(std::popcount(joined[w]));
  }
  if (voxels == 0) return;
  to.key.push_back(key);
  to.mask.insert(to.mask.end(), joined.begin(), joined.end());
  to.first.push_back(to.first.back() + voxels);
}

/// Returns the bricks `keys` of a level after the edits. `inside` has the voxels of the cubes.
Level joined(const Level& before, const Level& inside, const EditedCubes& cubes, int lod,
             std::span<const std::uint64_t> keys) {
  if (cubes.contains_whole_bricks(lod)) return bricks_of(inside, keys);
  Level out;
  out.first = {0};
  for (const std::uint64_t key : keys) append_joined(before, inside, mask_in(cubes, lod, key), key, out);
  return out;
}

/// The place of a row of a downsample state, in the order of the rows.
std::tuple<std::uint8_t, std::uint64_t, std::uint32_t> order_of(const std::uint8_t* place) {
  const auto brick = [&](int c) { return std::uint32_t(place[c] / brick_edge); };
  const auto inside = [&](int c) { return std::uint32_t(place[c] % brick_edge); };
  return {place[0], morton(brick(1), brick(2), brick(3)), inside(1) + 8 * inside(2) + 64 * inside(3)};
}

/// Returns the rows of `stored` outside of the cubes and the rows of `fresh` inside, in their order.
DownsampleState joined(const DownsampleState& stored, const DownsampleState& fresh, const EditedCubes& cubes,
                       int coarsest) {
  struct Row {
    const DownsampleState* of;
    std::size_t number;
    const std::uint8_t* place() const { return &of->place[source_place_bytes * number]; }
  };
  std::vector<Row> rows;
  for (std::size_t r = 0; r < fresh.voxels(); ++r) rows.push_back({&fresh, r});
  for (std::size_t r = 0; r < stored.voxels(); ++r) {
    const std::uint8_t* p = &stored.place[source_place_bytes * r];
    if (!cubes.contains(coarsest - p[0], {p[1], p[2], p[3]})) rows.push_back({&stored, r});
  }
  std::sort(rows.begin(), rows.end(),
            [](const Row& a, const Row& b) { return order_of(a.place()) < order_of(b.place()); });
  DownsampleState out;
  const auto add = [](const auto& from, std::size_t row, std::size_t rows_of_column, auto& to) {
    const std::size_t width = rows_of_column == 0 ? 0 : from.size() / rows_of_column;
    to.insert(to.end(), from.begin() + std::ptrdiff_t(width * row), from.begin() + std::ptrdiff_t(width * (row + 1)));
  };
  const auto coarse_rows = [](const DownsampleState& of) {
    std::size_t count = 0;
    while (count < of.voxels() && of.place[source_place_bytes * count] == 0) ++count;
    return count;
  };
  const std::size_t of_fresh = coarse_rows(fresh), of_stored = coarse_rows(stored);
  for (const Row& row : rows) {
    const DownsampleState& from = *row.of;
    add(from.place, row.number, from.voxels(), out.place);
    add(from.rgba, row.number, from.voxels(), out.rgba);
    add(from.normal, row.number, from.voxels(), out.normal);
    add(from.voxel_class, row.number, from.voxels(), out.voxel_class);
    if (row.place()[0] != 0) continue;
    add(from.raster, row.number, row.of == &fresh ? of_fresh : of_stored, out.raster);
    add(from.patch, row.number, row.of == &fresh ? of_fresh : of_stored, out.patch);
  }
  return out;
}

/// The voxels of the cubes on all levels, and their downsample state.
struct CubeVoxels {
  std::vector<Level> levels;
  DownsampleState above;
};

CubeVoxels filtered(Level finest, std::uint32_t lods, const kernels::CellParameters& parameters,
                    const ThreadPool& pool) {
  CubeVoxels out;
  out.levels.resize(1);
  const bool has_voxels = !finest.key.empty();
  out.levels[0] = std::move(finest);
  if (!has_voxels) {
    out.levels.resize(lods);
    return out;
  }
  kernels::LevelSurface surface;
  kernels::add_coarser_levels(out.levels, surface, int(lods), parameters.mip, parameters.normals, pool);
  out.above = kernels::downsample_state(out.levels, int(lods) - 1, surface, parameters.mip);
  if (!parameters.directional_coverage) kernels::drop_directional_coverage(out.levels);
  return out;
}

}  // namespace

EditedCubes::EditedCubes(std::uint32_t lods, std::span<const std::uint64_t> bricks)
    : level_(std::max(0, int(lods) - 1 - 3)) {
  for (const std::uint64_t brick : bricks) {
    // A block of bricks may be larger than a cube.
    const std::uint64_t block = std::min<std::uint64_t>(std::uint64_t(1) << 3 * (lods - 1), 64);
    for (std::uint64_t b = brick; b < brick + block; b += std::uint64_t(1) << 3 * level_)
      if (const std::uint64_t cube = b >> 3 * level_; cubes_.empty() || cubes_.back() != cube) cubes_.push_back(cube);
  }
}

std::vector<EditedCubes::Range> EditedCubes::ranges() const {
  std::vector<Range> out;
  for (const std::uint64_t cube : cubes_) {
    const Range range{cube << 3 * level_, (cube + 1) << 3 * level_};
    if (!out.empty() && out.back().end == range.first)
      out.back().end = range.end;
    else
      out.push_back(range);
  }
  return out;
}

bool EditedCubes::contains(int lod, const Vec3<std::uint32_t>& voxel) const {
  const auto cube = [&](std::size_t c) { return (voxel[c] << lod) >> (3 + level_); };
  return std::binary_search(cubes_.begin(), cubes_.end(), morton(cube(0), cube(1), cube(2)));
}

EditedLevels edited_levels(const BaseShard& base, const StoredBricks& stored, const EditedCubes& cubes,
                           const CellEdits& edits, const kernels::CellParameters& parameters, const ThreadPool& pool) {
  const auto lods = std::uint32_t(base.lods());
  std::vector<std::uint64_t> keys;
  for (const EditedCubes::Range& range : cubes.ranges()) {
    const std::vector<std::uint64_t> more = stored.finest_keys(range.first, range.end);
    keys.insert(keys.end(), more.begin(), more.end());
  }
  const Level before = stored.read(0, keys);
  Level after = before;
  edits.functions().apply(after, 0, std::uint64_t(1) << 3 * (lods - 1));
  if (parameters.kept) kernels::clip(after, 0, parameters, pool);
  EditedLevels out;
  out.levels.resize(lods);
  out.levels[0].keys = changed_keys(before, after);
  out.levels[0].before = bricks_of(before, out.levels[0].keys);
  out.levels[0].after = bricks_of(after, out.levels[0].keys);
  const CubeVoxels voxels = filtered(std::move(after), lods, parameters, pool);
  for (std::uint32_t lod = 1; lod < lods; ++lod) {
    EditedLevel& level = out.levels[lod];
    for (const std::uint64_t key : out.levels[lod - 1].keys)
      if (level.keys.empty() || level.keys.back() != key >> 3) level.keys.push_back(key >> 3);
    level.before = stored.read(int(lod), level.keys);
    level.after = joined(level.before, voxels.levels[lod], cubes, int(lod), level.keys);
  }
  out.above = joined(base.above(), voxels.above, cubes, int(lods) - 1);
  return out;
}

}  // namespace gigabake
