/// What the module "openvdb" does: grids that are filled brick by brick and become a file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "format/scene/scene_level.h"
#include "format/scene/scene_xml.h"

namespace gigabake {

/// The grids that export_openvdb() promises.
class OpenvdbGrids {
 public:
  virtual ~OpenvdbGrids() = default;
  /// lowest: multiples of 8.
  virtual void add(const std::array<std::int32_t, 3>& lowest, const DenseBrick& part) = 0;
  /// About what they take in memory.
  virtual std::uint64_t bytes() const = 0;
  /// Into `aside`, read back there. Errors  InputError naming `vdb`: the disk is full, or reads other than was written.
  virtual void write(const std::filesystem::path& vdb, const std::filesystem::path& aside) const = 0;
};

struct OpenvdbModule {
  std::unique_ptr<OpenvdbGrids> (*grids_of)(const SceneHeader& scene, int lod);
};

}  // namespace gigabake

/// The module's only symbol. Its lifetime is the process's.
extern "C" const gigabake::OpenvdbModule* gigabake_openvdb();
