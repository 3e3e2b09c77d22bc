#include "format/scene/scene_page.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <numeric>

#include "format/scene/check/scene_check.h"
#include "format/scene/xml/scene_elements.h"
#include "format/scene/xml/scene_reading.h"
#include "format/scene/xml/scene_text.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_page_bytes = std::uint64_t(1) << 28;

std::span<const std::string_view> known_of_page() {
  static const std::vector<std::string_view> known =
      with_totals({"Version", "Compressed", "BrickXSize", "BrickYSize", "BrickZSize", "VoxelSize", "LatticeOrigin",
                   "Channels", "BlockMin", "BlockVoxels", "Groups", "Checksum"});
  return known;
}

/// Checks that the page is the page that its reference describes. Returns the version of the page.
int expect_page_of(const std::filesystem::path& path, const SceneAttributes& a, const SceneHeader& header,
                   const PageReference& reference) {
  const int version = a.value<int>("Version");
  if (version < 3 || version > newest_page_version)
    a.fail("Version", fmt::format("expected 3 to {}; a newer gigabake wrote this page", newest_page_version));
  SceneHeader own;
  read_lattice(a, own);
  if (own.voxel_size_m != header.voxel_size_m || own.lattice_origin_m != header.lattice_origin_m ||
      own.has_normals != header.has_normals || own.has_directional_coverage != header.has_directional_coverage ||
      own.has_classes != header.has_classes)
    a.fail("VoxelSize", "a page of another scene: voxel size, lattice or channels differ; bake again");
  if (read_block(a) != reference.block) a.fail("BlockMin", "is of another block than its reference; bake again");
  if (a.value<std::uint64_t>("Groups") != reference.groups) a.fail("Groups", "differs from its reference; bake again");
  const auto differences = faults_of_totals(read_totals(a, version), reference.totals, "OctTreeGroup");
  if (!differences.empty()) throw InputError(path, differences[0].key, "differs from its reference; bake again");
  return version;
}

SceneTotals sum_of(const ScenePage& page) {
  SceneTotals sum(page.cells);
  for (const PageReference& below : page.pages) sum.add(below.totals);
  for (const SceneCell& overview : page.overviews) sum.add(overview);
  return sum;
}

/// Returns the differences between a page's content and its reference.
std::vector<SceneFault> contradictions_of(const ScenePage& page, const PageReference& reference,
                                          const SceneHeader& header) {
  std::vector<SceneFault> all = faults_of_totals(reference.totals, sum_of(page), "OctTreeGroup");
  const auto add = [&all](std::vector<SceneFault> faults) {
    std::move(faults.begin(), faults.end(), std::back_inserter(all));
  };
  if (page.pages.size() != reference.groups)
    add({{"OctTreeGroup Groups",
          fmt::format("states {}, but {} are listed", reference.groups, page.pages.size()),
          {}}});
  for (const SceneCell& cell : page.cells)
    if (block_around(cell.lattice_min, reference.block.edge) != reference.block)
      add({{"PagedOctTree " + as_line(cell.name, max_quote_bytes), "does not begin in the block of its page", {}}});
  add(faults_of_blocks(page.pages, &reference.block));
  add(faults_of_places(page.cells, page.overviews));
  add(faults_of_overview_places(page, &reference.block, header.tiers));
  return all;
}

}  // namespace

PageReading read_page_text(const std::filesystem::path& scene_xml, const SceneHeader& header,
                           const PageReference& reference) {
  const std::filesystem::path path = scene_xml.parent_path() / reference.file;
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError(
        path, "",
        "is missing, but the scene refers to it; if a bake has replaced the scene since it was opened, open it "
        "again, otherwise bake again");
  const SceneText text(path, max_page_bytes);
  if (!text.checksum().is_said || text.checksum().value != reference.checksum)
    throw InputError(path, "OctTreeGroup Checksum",
                     "is not the page that the scene refers to, or was changed since; bake again");
  PageReading reading;
  const pugi::xml_node group = root_of(path, text.document(), reading.faults);
  const SceneAttributes a(path, group);
  const int version = expect_page_of(path, a, header, reference);
  GroupContent content = read_content(path, group, header, version, {});
  const auto add = [&reading](const std::vector<SceneFault>& faults) {
    reading.faults.insert(reading.faults.end(), faults.begin(), faults.end());
  };
  add(faults_of_root(a, known_of_page()));
  add(content.faults);
  for (const SceneLoss& loss : content.losses)
    add({{"Loss " + as_line(loss.name, max_quote_bytes), "is listed in a page; expected it in scene.xml", {}}});
  reading.page = {std::move(content.cells), std::move(content.pages), std::move(content.overviews)};
  if (version < 5)
    for (const SceneCell& overview : reading.page.overviews)
      reading.contradictions.push_back(
          {"PagedOctTree " + as_line(overview.name, max_quote_bytes),
           "is an overview and is listed in a page of version 3 or 4; expected it in scene.xml",
           {}});
  std::ranges::move(contradictions_of(reading.page, reference, header), std::back_inserter(reading.contradictions));
  return reading;
}

ScenePage read_page(const std::filesystem::path& scene_xml, const SceneHeader& header, const PageReference& reference) {
  PageReading reading = read_page_text(scene_xml, header, reference);
  if (!reading.contradictions.empty())
    throw error_of(scene_xml.parent_path() / reference.file, reading.contradictions[0]);
  return std::move(reading.page);
}

}  // namespace gigabake
