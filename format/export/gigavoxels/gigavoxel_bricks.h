/// Reader of a GigaVoxels octree's brick file, brick by brick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math/vec3.h"
#include "format/export/gigavoxels/gigavoxel_tree.h"
#include "format/system/descriptor.h"

namespace gigabake {

/// A brick with its border; x varies fastest.
struct GigavoxelBrickData {
  Vec3<std::uint64_t> size{};
  Vec3<std::uint32_t> border{};        ///< number of border voxels before the first inner voxel, per axis
  std::vector<std::uint8_t> rgba;      ///< 4 per voxel
  std::vector<std::uint8_t> gradient;  ///< 3 per voxel
};

/// An open brick file.
/// Errors  InputError naming file, byte and rule, from every member.
class GigavoxelBrickFile {
 public:
  /// Locates every brick and checks the sizes of all bricks. `brick` is the octree's brick size without borders.
  GigavoxelBrickFile(const std::filesystem::path& path, const Vec3<std::uint32_t>& brick);

  std::size_t size() const { return begin_.size(); }
  GigavoxelBrickData read(std::size_t number) const;

 private:
  struct Head;
  Head read_head(std::uint64_t at) const;
  void read_at(std::uint64_t at, void* to, std::uint64_t bytes) const;

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
  Vec3<std::uint32_t> brick_;
  std::vector<std::uint64_t> begin_;
};

}  // namespace gigabake
