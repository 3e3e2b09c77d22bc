#include "format/scene/tier_shape.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <map>
#include <set>

#include "core/octree/brick.h"
#include "format/scene/scene_page.h"

namespace gigabake {
namespace {

constexpr int max_window_bits = 31;

TierShape shape_of(const SceneCell& overview) { return {overview.first_lod, overview.copied_lods, overview.lods}; }

/// Returns whether the overview's corner is a multiple of `grid`, as it must be for all windows below the root.
bool is_on_grid(const SceneCell& overview, std::int64_t grid) {
  return std::ranges::all_of(overview.lattice_min, [grid](std::int64_t v) { return v % grid == 0; });
}

/// Returns whether the overview has the levels of `tier` and a valid window.
bool is_of_tier(const SceneCell& overview, const TierShape& tier, bool is_root) {
  const std::int64_t edge = std::int64_t(1) << tier.window_bits();
  return shape_of(overview) == tier && overview.cell_voxels == edge && is_on_grid(overview, is_root ? edge / 2 : edge);
}

/// The overviews of one level, by the corners of their windows.
using Tier = std::set<Vec3i64>;

/// Returns whether a window of the level contains the voxel. `is_alone` is true if the level has only one window, which
/// need not be aligned to its edge.
bool has_around(const Tier& tier, const TierShape& shape, bool is_alone, const Vec3i64& voxel) {
  const std::int64_t edge = std::int64_t(1) << shape.window_bits();
  return is_alone ? LatticeBlock{*tier.begin(), edge}.box().contains(voxel)
                  : tier.contains(block_around(voxel, edge).min);
}

/// Returns whether each overview of `tier` lies in an overview of the next higher level.
bool lies_below(const Tier& tier, const TierShape& above_shape, const Tier& above, bool above_is_root) {
  return std::ranges::all_of(
      tier, [&](const Vec3i64& corner) { return has_around(above, above_shape, above_is_root, corner); });
}

/// Returns whether overviews may be missing without a record, because a cell or overview below them is lost.
bool may_lack_overviews(const SceneHeader& scene) {
  return std::ranges::any_of(scene.losses, [](const SceneLoss& loss) {
    return loss.name.starts_with("parent ") || loss.name.starts_with("cell ");
  });
}

/// Returns the overview levels by native lod. Returns an empty map if two overviews of the same lod differ in shape.
std::map<std::uint32_t, TierShape> shapes_by_lod(std::span<const SceneCell> overviews) {
  std::map<std::uint32_t, TierShape> shapes;
  for (const SceneCell& overview : overviews)
    if (shapes.emplace(overview.own_lod(), shape_of(overview)).first->second != shape_of(overview)) return {};
  return shapes;
}

bool hang_from_one_root(std::span<const SceneCell> overviews, const std::vector<TierShape>& shapes) {
  std::map<std::uint32_t, Tier> tiers;
  for (const SceneCell& overview : overviews) {
    const auto shape = std::ranges::find(shapes, overview.own_lod(), &TierShape::own_lod);
    if (!is_of_tier(overview, *shape, shape == shapes.end() - 1)) return false;
    if (!tiers[overview.own_lod()].insert(overview.lattice_min).second) return false;
  }
  for (std::size_t t = 0; t + 1 < shapes.size(); ++t)
    if (!lies_below(tiers[shapes[t].own_lod()], shapes[t + 1], tiers[shapes[t + 1].own_lod()], t + 2 == shapes.size()))
      return false;
  return tiers[shapes.back().own_lod()].size() == 1;
}

}  // namespace

std::optional<std::string> fault_of_tiers(std::span<const TierShape> tiers, std::uint32_t cell_voxels) {
  std::uint32_t next = std::uint32_t(std::bit_width(cell_voxels / std::uint32_t(brick_edge)));
  if (next == 0) return "the cells have different sizes";
  std::uint32_t first_lod = 0;
  for (const TierShape& tier : tiers) {
    if (tier.first_lod < 1 || tier.first_lod < first_lod || tier.copied_lods >= tier.lods ||
        tier.lods > std::uint32_t(max_window_bits) || tier.first_lod > std::uint32_t(max_window_bits) ||
        tier.window_bits() > max_window_bits)
      return "are not numbers of overview levels";
    if (tier.own_lod() != next)
      return fmt::format("an overview level begins at lod {}, but lod {} is missing or duplicated", tier.own_lod(),
                         next);
    next = tier.end_lod();
    first_lod = tier.first_lod;
  }
  return std::nullopt;
}

std::optional<std::string> fault_in_tiers(const SceneCell& overview, std::span<const TierShape> tiers) {
  if (tiers.empty()) return std::nullopt;
  for (const TierShape& tier : tiers)
    if (tier.own_lod() == overview.own_lod())
      return is_of_tier(overview, tier, &tier == &tiers.back())
                 ? std::nullopt
                 : std::optional<std::string>("has other levels or another grid than in ParentTiers");
  return "has levels that ParentTiers does not list";
}

bool cover_cells(CellPart part, std::span<const SceneCell> overviews, const TierShape& lowest,
                 const CellWalk& for_each_cell) {
  Tier tier;
  for (const SceneCell& overview : overviews)
    if (shape_of(overview) == lowest) tier.insert(overview.lattice_min);
  const auto is_held = [&](const Vec3i64& voxel) { return has_around(tier, lowest, tier.size() == 1, voxel); };
  bool all = true;
  for_each_cell([&](const SceneCell& cell) {
    Vec3i64 high = cell.lattice_min;
    high[2] += std::int64_t(cell.cell_voxels) - 1;
    const bool low_is = is_held(cell.lattice_min), high_is = is_held(high);
    all = all && (part == CellPart::all ? low_is && high_is : low_is || high_is);
  });
  return all;
}

std::vector<TierShape> tiers_of(std::span<const SceneCell> overviews, const SceneHeader& header,
                                std::uint32_t cell_voxels, const CellWalk& for_each_cell) {
  std::vector<TierShape> shapes;
  for (const auto& [lod, shape] : shapes_by_lod(overviews)) shapes.push_back(shape);
  if (shapes.empty() || fault_of_tiers(shapes, cell_voxels) || !hang_from_one_root(overviews, shapes)) return {};
  if (may_lack_overviews(header) && !cover_cells(CellPart::all, overviews, shapes.front(), for_each_cell)) return {};
  return shapes;
}

std::vector<TierShape> tiers_of(const SceneDescription& scene, std::uint32_t cell_voxels) {
  return tiers_of(scene.overviews, scene, cell_voxels, [&scene](const auto& visit) {
    for (const SceneCell& cell : scene.cells) visit(cell);
  });
}

}  // namespace gigabake
