/// Reader of a GigaVoxels octree's brick file, brick by brick.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/export/gigavoxels/gigavoxel_tree.h"
#include "format/system/descriptor.h"

namespace gigabake {

/// A brick with its border; x varies fastest.
struct GigavoxelBrickData {
  std::array<std::uint64_t, 3> size{};
  std::array<std::uint32_t, 3> border{};  ///< number of border voxels before the brick's own
  std::vector<std::uint8_t> rgba;         ///< 4 per voxel
  std::vector<std::uint8_t> gradient;     ///< 3 per voxel
};

/// A brick file.
/// Errors  InputError from every member: file, byte, rule.
class GigavoxelBrickFile {
 public:
  /// Locates every brick and checks sizes. `brick` is the octree's brick size without borders.
  GigavoxelBrickFile(const std::filesystem::path& path, const std::array<std::uint32_t, 3>& brick);

  std::size_t size() const { return begin_.size(); }
  GigavoxelBrickData read(std::size_t number) const;

 private:
  struct Head;
  Head read_head(std::uint64_t at) const;
  void read_at(std::uint64_t at, void* to, std::uint64_t bytes) const;

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
  std::array<std::uint32_t, 3> brick_;
  std::vector<std::uint64_t> begin_;
};

}  // namespace gigabake
