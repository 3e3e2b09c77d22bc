#include "format/export/openvdb/openvdb_export.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "format/export/openvdb/openvdb_module.h"
#include "format/system/host_limits.h"
#include "format/system/module.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

Vec3<std::int32_t> checked_index(const std::filesystem::path& scene_xml, const LevelIndex& index) {
  for (const std::int64_t i : index)
    if (i != std::int32_t(i))
      throw InputError(scene_xml, "LatticeMin", "OpenVDB cannot store indices of more than 32 bits");
  return {std::int32_t(index[0]), std::int32_t(index[1]), std::int32_t(index[2])};
}

std::unique_ptr<OpenvdbGrids> grids_of(const SceneHeader& scene, int lod) {
  static const OpenvdbModule& module =
      *reinterpret_cast<decltype(&gigabake_openvdb)>(module_function("openvdb", "gigabake_openvdb"))();
  return module.grids_of(scene, lod);
}

}  // namespace

std::uint64_t openvdb_memory_bytes() { return host_limits().memory_bytes / 2; }

std::uint64_t export_openvdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& vdb,
                             std::uint64_t max_bytes, const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  const std::unique_ptr<OpenvdbGrids> grids = grids_of(scene.header(), lod);
  Publication publication(vdb, Leftovers::remove);
  std::uint64_t parts = 0;
  progress.step("collecting the voxels", voxels);
  const auto add = [&](const LevelIndex& lowest, const DenseBrick& part) {
    grids->add(checked_index(scene_xml, lowest), part);
    if (++parts % 256 == 0 && grids->bytes() > max_bytes)
      throw InputError(scene_xml, "",
                       fmt::format("its grids take more than {} MiB of memory; a coarser `lod` or `to` nvdb takes less",
                                   max_bytes >> 20));
  };
  for_each_block_part(scene, lod, add, progress);
  progress.step("writing the grids");
  grids->write(vdb, publication.temporary());
  publication.publish();
  return voxels;
}

}  // namespace gigabake
