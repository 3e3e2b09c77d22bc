#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <pugixml.hpp>

#include "format/scene/tier_shape.h"
#include "format/scene/xml/element_text.h"
#include "format/scene/xml/page_write.h"
#include "format/scene/xml/scene_xml.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

void set_header(pugi::xml_node group, const SceneHeader& scene) {
  set_schema(group, scene.has_classes     ? first_scene_version_of_classes
                    : scene.leaf_lod != 0 ? first_scene_version_of_leaves
                                          : newest_page_version);
  set_text(group, "Generator", scene.generator);
  set_lattice(group, scene);
  if (scene.origin)
    set_text(group, "Origin",
             fmt::format("{} {} {}", scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m));
  set_text(group, "Parameters", scene.parameters);
  if (scene.leaf_lod != 0) set_number(group, "LeafLod", scene.leaf_lod);
  if (!scene.bounds.is_empty()) {
    set_numbers(group, "BoundsMin", scene.bounds.min);
    set_numbers(group, "BoundsEnd", scene.bounds.end);
  }
  set_number(group, "Triangles", scene.triangles);
  set_number(group, "NonFinite", scene.non_finite);
  set_number(group, "ZeroArea", scene.zero_area);
  set_number(group, "SkippedPoints", scene.skipped_points);
  set_number(group, "SkippedLines", scene.skipped_lines);
}

void set_tiers(pugi::xml_node group, const std::vector<TierShape>& tiers) {
  std::vector<std::uint32_t> numbers;
  for (const TierShape& tier : tiers)
    for (const std::uint32_t number : {tier.first_lod, tier.copied_lods, tier.lods}) numbers.push_back(number);
  if (!tiers.empty()) set_numbers(group, "ParentTiers", numbers);
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneDescription& scene, const PageRule& rule) {
  const SceneTotals totals(scene);
  const bool has_pages = scene.cells.size() > rule.max_cells_per_file && totals.cell_voxels != 0;
  const ScenePage paged = has_pages ? write_pages(path, scene, rule) : ScenePage();
  pugi::xml_document document;
  pugi::xml_node group = document.append_child("OctTreeGroup");
  set_header(group, scene);
  set_totals(group, totals);
  set_tiers(group, tiers_of(scene, totals.cell_voxels));
  for (const PageReference& page : paged.pages) append_reference(group, scene, page);
  if (!has_pages)
    for (const SceneCell& cell : scene.cells) append_cell(group, scene, cell);
  std::vector<const SceneCell*> overviews;
  for (const SceneCell& overview : has_pages ? paged.overviews : scene.overviews) overviews.push_back(&overview);
  append_overviews(group, scene, overviews);
  for (const SceneLoss& loss : scene.losses) {
    pugi::xml_node n = group.append_child("Loss");
    set_text(n, "Name", loss.name);
    set_text(n, "Reason", loss.reason);
  }
  publish_file(path, summed_text(document).text);
}

}  // namespace gigabake
