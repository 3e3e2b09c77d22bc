#include <cmath>
#include <fmt/format.h>
#include <pugixml.hpp>
#include <sstream>

#include "format/scene/scene_reading.h"
#include "format/scene/scene_totals.h"
#include "format/scene/scene_xml.h"
#include "format/shard/channels.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

template <class Range, class Text>
std::string joined(const Range& values, const Text& text) {
  std::string out;
  for (const auto& v : values) out += (out.empty() ? "" : " ") + text(v);
  return out;
}

const auto number = [](auto v) { return fmt::format("{}", v); };

void set(pugi::xml_node node, const char* key, const std::string& value) { node.append_attribute(key) = value.c_str(); }

void append_cell(pugi::xml_node group, const SceneDescription& scene, const SceneCell& cell) {
  pugi::xml_node n = group.append_child("PagedOctTree");
  const double edge_m = cell.cell_voxels * scene.voxel_size_m;
  const char* const centre[3] = {"CenterX", "CenterY", "CenterZ"};
  for (int c = 0; c < 3; ++c)
    set(n, centre[c],
        number(scene.lattice_origin_m[std::size_t(c)] + double(cell.lattice_min[std::size_t(c)]) * scene.voxel_size_m +
               edge_m / 2));
  set(n, "Radius", number(edge_m * std::sqrt(3.0) / 2));
  set(n, "TreeFile", cell.file);
  set(n, "Name", cell.name);
  set(n, "LatticeMin", joined(cell.lattice_min, number));
  set(n, "CellVoxels", number(cell.cell_voxels));
  if (cell.first_lod != 0) set(n, "FirstLod", number(cell.first_lod));
  set(n, "Lods", number(cell.lods));
  set(n, "Bytes", number(cell.bytes));
  set(n, "Triangles", number(cell.triangles));
  set(n, "Voxels", joined(cell.voxels, number));
  set(n, "Fingerprint", cell.fingerprint.hex());
  set(n, "ContentHash", joined(cell.content_hash, [](const Hash128& h) { return h.hex(); }));
}

pugi::xml_node append_group(pugi::xml_document& document, const SceneDescription& scene) {
  pugi::xml_node g = document.append_child("OctTreeGroup");
  set(g, "Version", number(newest_scene_version));
  set(g, "Compressed", "1");
  for (const char* key : {"BrickXSize", "BrickYSize", "BrickZSize"}) set(g, key, number(brick_edge));
  set(g, "Generator", scene.generator);
  set(g, "VoxelSize", number(scene.voxel_size_m));
  set(g, "LatticeOrigin", joined(scene.lattice_origin_m, number));
  if (scene.origin)
    set(g, "Origin",
        fmt::format("{} {} {}", scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m));
  set(g, "Channels", channel_names(scene.has_normals, scene.has_facing));
  set(g, "Parameters", scene.parameters);
  set(g, "Triangles", number(scene.triangles));
  set(g, "NonFinite", number(scene.non_finite));
  set(g, "ZeroArea", number(scene.zero_area));
  set(g, "SkippedPoints", number(scene.skipped_points));
  set(g, "SkippedLines", number(scene.skipped_lines));
  const SceneTotals totals(scene);
  set(g, "Cells", number(scene.cells.size()));
  set(g, "Parents", number(scene.parents.size()));
  set(g, "Voxels", joined(totals.voxels, number));
  set(g, "ContentHash", totals.all_content.hex());
  set(g, "Checksum", Hash128().hex());
  return g;
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneDescription& scene) {
  pugi::xml_document document;
  pugi::xml_node group = append_group(document, scene);
  for (const SceneCell& cell : scene.cells) append_cell(group, scene, cell);
  if (!scene.parents.empty()) {
    pugi::xml_node parents = group.append_child("OctTreeGroup");
    for (const SceneCell& parent : scene.parents) append_cell(parents, scene, parent);
  }
  for (const SceneLoss& loss : scene.losses) {
    pugi::xml_node n = group.append_child("Loss");
    set(n, "Name", loss.name);
    set(n, "Reason", loss.reason);
  }
  std::ostringstream text;
  document.save(text, "  ");
  publish_file(path, with_checksum(text.str()));
}

}  // namespace gigabake
