#include "stored_hill.h"

#include "core/octree/parameters.h"
#include "tests/format/shard/made_shard.h"

namespace gigabake {

void write_hill(const std::filesystem::path& scene_xml, const std::array<std::uint8_t, 4>& rgba) {
  std::vector<made::Voxel> voxels;
  for (std::int64_t y = 0; y < 32; ++y)
    for (std::int64_t x = 0; x < 32; ++x) voxels.push_back({{x, y, 8 + y / 2}, rgba, {0, 0}});
  const auto aside = scene_xml.parent_path() / "aside.xml";
  SceneDescription scene = made::write_scene_of(aside, {made::shard_of(voxels, {0, 0, 0}, 32)});
  scene.parameters = to_json(BakeParameters{.voxel_size_m = scene.voxel_size_m});
  write_scene(scene_xml, scene);
}

}  // namespace gigabake
