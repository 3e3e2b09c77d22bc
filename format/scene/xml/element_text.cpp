#include "format/scene/xml/element_text.h"

#include <cmath>
#include <sstream>

#include "format/scene/xml/scene_reading.h"
#include "format/shard/columns/channels.h"

namespace gigabake {
namespace {

std::vector<std::string> hex_of(const std::vector<Hash128>& hashes) {
  std::vector<std::string> out;
  for (const Hash128& hash : hashes) out.push_back(hash.hex());
  return out;
}

/// Writes the bounding sphere of a window, in the scene frame.
void set_sphere(pugi::xml_node node, const SceneHeader& scene, const Box3i64& window) {
  const Vec3d edge_m = Vec3d(window.size()) * scene.voxel_size_m;
  const Vec3d centre_m = scene.lattice_origin_m + Vec3d(window.min) * scene.voxel_size_m + edge_m / 2;
  set_number(node, "CenterX", centre_m[0]);
  set_number(node, "CenterY", centre_m[1]);
  set_number(node, "CenterZ", centre_m[2]);
  set_number(node, "Radius", length(edge_m) / 2);
}

}  // namespace

void set_schema(pugi::xml_node root, int version) {
  set_number(root, "Version", version);
  set_text(root, "Compressed", "1");
  for (const char* key : {"BrickXSize", "BrickYSize", "BrickZSize"}) set_number(root, key, brick_edge);
}

void set_lattice(pugi::xml_node root, const SceneHeader& scene) {
  set_number(root, "VoxelSize", scene.voxel_size_m);
  set_numbers(root, "LatticeOrigin", scene.lattice_origin_m);
  set_text(root, "Channels", channel_names({scene.has_normals, scene.has_directional_coverage, scene.has_classes}));
}

void set_totals(pugi::xml_node group, const SceneTotals& totals) {
  set_number(group, "Cells", totals.cells);
  set_number(group, "Parents", totals.overviews);
  set_numbers(group, "Voxels", totals.voxels);
  set_text(group, "ContentHash", totals.all_content().hex());
  set_numbers(group, "LevelContentHash", hex_of(totals.content_hash));
  set_number(group, "Bytes", totals.bytes);
  if (totals.has_stored()) {
    set_numbers(group, "LevelBytes", totals.level_bytes);
    set_number(group, "NodeBytes", totals.node_bytes);
  }
  if (totals.cell_voxels != 0) set_number(group, "CellVoxels", totals.cell_voxels);
  if (totals.cells == 0) return;
  set_numbers(group, "LatticeMin", totals.window.min);
  set_numbers(group, "LatticeEnd", totals.window.end);
}

void set_block(pugi::xml_node group, const LatticeBlock& block) {
  set_numbers(group, "BlockMin", block.min);
  set_number(group, "BlockVoxels", block.edge);
}

void append_cell(pugi::xml_node group, const SceneHeader& scene, const SceneCell& cell) {
  pugi::xml_node n = group.append_child("PagedOctTree");
  set_sphere(n, scene, window_of(cell));
  set_text(n, "TreeFile", cell.file);
  set_text(n, "Name", cell.name);
  set_numbers(n, "LatticeMin", cell.lattice_min);
  set_number(n, "CellVoxels", cell.cell_voxels);
  if (cell.first_lod != 0) {
    set_number(n, "FirstLod", cell.first_lod);
    set_number(n, "CopiedLods", cell.copied_lods);
  }
  set_number(n, "Lods", cell.lods);
  set_number(n, "Bytes", cell.bytes);
  if (!cell.level_bytes.empty()) {
    set_numbers(n, "LevelBytes", cell.level_bytes);
    set_number(n, "NodeBytes", cell.node_bytes);
  }
  set_number(n, "Triangles", cell.triangles);
  set_numbers(n, "Voxels", cell.voxels);
  set_text(n, "Fingerprint", cell.fingerprint.hex());
  set_numbers(n, "ContentHash", hex_of(cell.content_hash));
}

void append_overviews(pugi::xml_node group, const SceneHeader& scene, const std::vector<const SceneCell*>& overviews) {
  if (overviews.empty()) return;
  pugi::xml_node own = group.append_child("OctTreeGroup");
  for (const SceneCell* overview : overviews) append_cell(own, scene, *overview);
}

void append_reference(pugi::xml_node group, const SceneHeader& scene, const PageReference& page) {
  pugi::xml_node n = group.append_child("OctTreeGroup");
  set_sphere(n, scene, page.totals.window);
  set_text(n, "GroupFile", page.file);
  set_text(n, "GroupChecksum", page.checksum.hex());
  set_block(n, page.block);
  set_number(n, "Groups", page.groups);
  set_totals(n, page.totals);
}

SummedText summed_text(pugi::xml_document& document) {
  set_text(document.first_child(), "Checksum", Hash128().hex());
  std::ostringstream text;
  document.save(text, "  ");
  return summed(text.str());
}

}  // namespace gigabake
