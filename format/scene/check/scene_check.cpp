#include "format/scene/check/scene_check.h"

#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "format/scene/cell_window.h"
#include "format/scene/scene_page.h"
#include "format/scene/tier_shape.h"
#include "format/scene/xml/scene_elements.h"

namespace gigabake {
namespace {

class SceneFaults {
 public:
  void expect(bool holds, const std::string& key, const std::string& message) {
    if (!holds) all.push_back({key, message, {}});
  }
  std::vector<SceneFault> all;
};

/// Checks the stored summary, which scenes have since version 2.
void check_said(const SceneTotals& totals, const StoredTotals& said, SceneFaults& faults) {
  const char* const advice = "; lines were lost, added or changed: bake again";
  faults.expect(said.cells == totals.cells, "OctTreeGroup Cells",
                fmt::format("states {}, but {} are listed{}", said.cells, totals.cells, advice));
  faults.expect(said.overviews == totals.overviews, "OctTreeGroup Parents",
                fmt::format("states {}, but {} are listed{}", said.overviews, totals.overviews, advice));
  faults.expect(said.voxels == totals.voxels, "OctTreeGroup Voxels",
                fmt::format("are not the sums of the listed cells{}", advice));
  faults.expect(said.content_hash == totals.all_content(), "OctTreeGroup ContentHash",
                fmt::format("states {}, but the listed cells have {}{}", said.content_hash.hex(),
                            totals.all_content().hex(), advice));
}

void check_parameters(const BakeParameters& p, const SceneReading& reading, SceneFaults& faults) {
  const SceneDescription& scene = reading.scene;
  const auto expect = [&faults](bool holds, const char* key) {
    faults.expect(holds, "OctTreeGroup Parameters", fmt::format("{} differs from the scene's", key));
  };
  expect(p.voxel_size_m == scene.voxel_size_m, "voxel_size_m");
  expect(p.lattice_origin_m == scene.lattice_origin_m, "lattice_origin_m");
  expect(p.normals == scene.has_normals, "normals");
  // The parameters of some scenes of version 1 lack this member, because the channel did not exist.
  expect(reading.version < 2 || has_directional_coverage(p) == scene.has_directional_coverage, "facing");
  expect(p.classes == scene.has_classes, "classes");
  for (const SceneCell& cell : scene.cells)
    if (cell.cell_voxels != p.cell_voxels) return expect(false, "cell_voxels");
  for (const PageReference& page : reading.pages)
    if (page.totals.cell_voxels != p.cell_voxels) return expect(false, "cell_voxels");
}

}  // namespace

std::vector<SceneFault> faults_of_places(const std::vector<SceneCell>& cells, const std::vector<SceneCell>& overviews) {
  SceneFaults faults;
  std::unordered_set<std::string_view> names, files;
  std::set<std::pair<std::uint32_t, Vec3i64>> places;
  for (const SceneCell& overview : overviews) {
    const std::string name = "PagedOctTree " + as_line(overview.name, max_quote_bytes);
    faults.expect(names.insert(overview.name).second, name, "another shard has the same name");
    faults.expect(files.insert(overview.file).second, name, "another shard has the same TreeFile");
    faults.expect(places.insert({overview.own_lod(), overview.lattice_min}).second, name,
                  "another overview has the same levels and LatticeMin");
  }
  for (const SceneCell& cell : cells) {
    const std::string name = "PagedOctTree " + as_line(cell.name, max_quote_bytes);
    faults.expect(names.insert(cell.name).second, name, "another cell has the same name");
    faults.expect(files.insert(cell.file).second, name, "another cell has the same TreeFile");
    faults.expect(places.insert({0, cell.lattice_min}).second, name, "another cell has the same LatticeMin");
  }
  return std::move(faults.all);
}

std::vector<SceneFault> faults_of_overview_places(const ScenePage& page, const LatticeBlock* outer,
                                                  std::span<const TierShape> tiers) {
  SceneFaults faults;
  std::set<Vec3i64> blocks;
  for (const PageReference& below : page.pages) blocks.insert(below.block.min);
  std::uint32_t highest = outer != nullptr && !tiers.empty() ? tiers.back().own_lod() : 0;
  for (const SceneCell& overview : page.overviews)
    if (outer == nullptr) highest = std::max(highest, overview.own_lod());
  std::size_t roots = 0;
  for (const SceneCell& overview : page.overviews) {
    const std::string name = "PagedOctTree " + as_line(overview.name, max_quote_bytes);
    const bool is_highest = overview.own_lod() == highest;
    roots += is_highest;
    faults.expect(outer == nullptr || !is_highest, name,
                  "is the root and is listed in a page; expected it in scene.xml");
    faults.expect(outer == nullptr || lies_in(overview, *outer), name, "does not lie in the block of its page");
    if (!page.pages.empty() && !is_highest) {
      const LatticeBlock below = block_around(overview.lattice_min, page.pages[0].block.edge);
      faults.expect(!blocks.contains(below.min) || !lies_in(overview, below), name,
                    "belongs to the block of a smaller page; expected it there");
    }
    if (const auto fault = fault_in_tiers(overview, tiers)) faults.expect(false, name, *fault);
  }
  faults.expect(tiers.empty() || outer != nullptr || (roots == 1 && highest == tiers.back().own_lod()),
                "OctTreeGroup ParentTiers", "names a root that is missing or listed more than once; bake again");
  return std::move(faults.all);
}

std::vector<SceneFault> faults_of_listed(const SceneReading& reading) {
  SceneFaults faults{faults_of_places(reading.scene.cells, reading.scene.overviews)};
  const auto add = [&faults](std::vector<SceneFault> more) {
    std::move(more.begin(), more.end(), std::back_inserter(faults.all));
  };
  add(faults_of_blocks(reading.pages, nullptr));
  if (reading.version >= 5)
    add(faults_of_overview_places({{}, reading.pages, reading.scene.overviews}, nullptr, reading.scene.tiers));
  SceneTotals totals(reading.scene);
  for (const PageReference& page : reading.pages) totals.add(page.totals);
  if (reading.said) check_said(totals, *reading.said, faults);
  if (reading.totals) add(faults_of_totals(*reading.totals, totals, "OctTreeGroup"));
  return std::move(faults.all);
}

std::vector<SceneFault> overlaps_of_cells(const std::vector<SceneCell>& all, const LatticeBlock* block) {
  SceneFaults faults;
  const CellFinder finder(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (block != nullptr && block_around(all[i].lattice_min, block->edge) != *block) continue;
    for (const std::size_t other : finder.overlapping(window_of(all[i])))
      faults.expect(other <= i || all[other].lattice_min == all[i].lattice_min,
                    "PagedOctTree " + as_line(all[i].name, max_quote_bytes),
                    "overlaps cell " + as_line(all[other].name, max_quote_bytes));
  }
  return std::move(faults.all);
}

std::vector<SceneFault> faults_of_parameters(const SceneReading& reading) {
  SceneFaults faults;
  const char* const key = "OctTreeGroup Parameters";
  const auto json = nlohmann::json::parse(reading.scene.parameters, nullptr, false);
  if (!json.is_object()) {
    faults.expect(false, key, "expected the bake's parameters as JSON");
    return faults.all;
  }
  if (reading.version < 2 && !json.contains("voxel_size_m")) return {};
  try {
    check_parameters(parameters_from_json(reading.scene.parameters), reading, faults);
  } catch (const std::exception&) {
    faults.expect(false, key, "are incomplete or out of range; expected the parameters of a bake");
  }
  return faults.all;
}

}  // namespace gigabake
