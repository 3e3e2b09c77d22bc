/// Interface of the module "openvdb": grids that are filled brick by brick and written to a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/math/vec3.h"
#include "format/scene/scene_level.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// The grids of export_openvdb().
class OpenvdbGrids {
 public:
  virtual ~OpenvdbGrids() = default;
  /// Adds the voxels of a block. `lowest` is a multiple of 8 on each axis.
  virtual void add(const Vec3<std::int32_t>& lowest, const DenseBrick& part) = 0;
  /// Returns the approximate memory of the grids in bytes.
  virtual std::uint64_t bytes() const = 0;
  /// Writes the grids to the file `temporary` and reads the last grid back.
  /// Errors  InputError naming `vdb`: the disk is full, or the grid read back has another number of voxels.
  virtual void write(const std::filesystem::path& vdb, const std::filesystem::path& temporary) const = 0;
};

struct OpenvdbModule {
  std::unique_ptr<OpenvdbGrids> (*grids_of)(const SceneHeader& scene, int lod);
};

}  // namespace gigabake

/// Returns the module, which lives as long as the process. This function is the only symbol that the library exports.
extern "C" const gigabake::OpenvdbModule* gigabake_openvdb();
