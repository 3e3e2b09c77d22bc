#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <pugixml.hpp>

#include "format/scene/element_text.h"
#include "format/scene/page_write.h"
#include "format/scene/scene_xml.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

void set_header(pugi::xml_node group, const SceneHeader& scene) {
  set_schema(group);
  set_text(group, "Generator", scene.generator);
  set_lattice(group, scene);
  if (scene.origin)
    set_text(group, "Origin",
             fmt::format("{} {} {}", scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m));
  set_text(group, "Parameters", scene.parameters);
  set_number(group, "Triangles", scene.triangles);
  set_number(group, "NonFinite", scene.non_finite);
  set_number(group, "ZeroArea", scene.zero_area);
  set_number(group, "SkippedPoints", scene.skipped_points);
  set_number(group, "SkippedLines", scene.skipped_lines);
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneDescription& scene, const PageRule& rule) {
  const SceneTotals totals(scene);
  const bool has_pages = scene.cells.size() > rule.most_cells_of_a_file && totals.cell_voxels != 0;
  const std::vector<PageReference> pages = has_pages ? write_pages(path, scene, rule) : std::vector<PageReference>();
  pugi::xml_document document;
  pugi::xml_node group = document.append_child("OctTreeGroup");
  set_header(group, scene);
  set_totals(group, totals);
  set_number(group, "Parents", totals.parents);
  for (const PageReference& page : pages) append_reference(group, scene, page);
  if (pages.empty())
    for (const SceneCell& cell : scene.cells) append_cell(group, scene, cell);
  if (!scene.parents.empty()) {
    pugi::xml_node parents = group.append_child("OctTreeGroup");
    for (const SceneCell& parent : scene.parents) append_cell(parents, scene, parent);
  }
  for (const SceneLoss& loss : scene.losses) {
    pugi::xml_node n = group.append_child("Loss");
    set_text(n, "Name", loss.name);
    set_text(n, "Reason", loss.reason);
  }
  publish_file(path, summed_text(document).text);
}

}  // namespace gigabake
