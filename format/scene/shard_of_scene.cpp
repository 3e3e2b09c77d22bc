#include "format/scene/shard_of_scene.h"

#include <system_error>

#include "core/base/error.h"

namespace gigabake {

std::vector<HeaderDifference> differences_from_scene(const ShardHeader& header, const SceneHeader& scene,
                                                     const SceneCell& cell) {
  std::vector<HeaderDifference> found;
  const auto expect = [&](bool holds, const char* attribute, const std::string& what) {
    if (!holds) found.push_back({attribute, what});
  };
  expect(header.cell == cell.name, "cell",
         "is " + in_quotes(header.cell) + ", scene.xml states " + in_quotes(cell.name));
  expect(header.lattice_min == cell.lattice_min && header.cell_voxels == cell.cell_voxels && header.lods == cell.lods &&
             header.first_lod == cell.first_lod && header.copied_lods == cell.copied_lods,
         "lattice_min", "is of another window than in scene.xml");
  expect(header.voxel_size_m == scene.voxel_size_m, "voxel_size_m", "differs from scene.xml");
  expect(header.lattice_origin_m == scene.lattice_origin_m, "lattice_origin_m", "differs from scene.xml");
  expect(header.origin == scene.origin, "origin", "differs from scene.xml");
  expect(header.has_normals == scene.has_normals && header.has_directional_coverage == scene.has_directional_coverage &&
             header.has_classes == scene.has_classes,
         "channels", "differ from scene.xml");
  expect(header.leaf_lod <= scene.leaf_lod, "leaf_lod", "states leaves on a level where scene.xml has none");
  expect(header.triangles == cell.triangles, "triangles", "differ from scene.xml");
  expect(header.fingerprint == cell.fingerprint, "fingerprint", "differs from scene.xml: a shard of another bake");
  expect(header.content_hash == cell.content_hash, "content_hash", "differs from scene.xml");
  return found;
}

void expect_shard_of_scene(const std::filesystem::path& shard, const ShardHeader& header, const SceneHeader& scene,
                           const SceneCell& cell) {
  std::vector<HeaderDifference> differences = differences_from_scene(header, scene, cell);
  std::error_code error;
  if (const std::uintmax_t bytes = std::filesystem::file_size(shard, error); !error && bytes != cell.bytes)
    differences.push_back({"Bytes", "the file has " + std::to_string(bytes) + ", scene.xml states " +
                                        std::to_string(cell.bytes) + ": another program has changed it"});
  if (!differences.empty())
    throw InputError(shard, differences[0].attribute,
                     differences[0].what + "; gigabake verify lists all faults; bake again to fix them");
}

ShardReader open_shard_of_scene(const std::filesystem::path& scene_xml, const SceneHeader& scene,
                                const SceneCell& cell) {
  const std::filesystem::path path = scene_xml.parent_path() / cell.file;
  ShardReader reader(path);
  expect_shard_of_scene(path, reader.header(), scene, cell);
  return reader;
}

}  // namespace gigabake
