/// The levels of the faces of an OBJ, from the names of its materials, groups (`g`) and objects (`o`).
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/levels/named_voxel_sizes.h"

namespace gigabake {

/// The state of the lines that name materials, groups and objects. Groups count as nodes inside objects.
/// Exact   A `g` line names the text after it and each of its words, because some programs write names with spaces.
class ObjLevels {
 public:
  /// `sizes` may be null.
  explicit ObjLevels(const NamedVoxelSizes* sizes) : sizes_(sizes) {}

  /// Returns to the state at the beginning of the file.
  void restart();
  /// Takes a line; lines other than `usemtl`, `g` and `o` have no effect.
  void take(std::string_view word, std::string_view rest);
  /// Returns the level of faces at the current line: that of the material, else of the group, else of the object.
  std::int32_t lod() const;
  /// Returns TileMesh::sized, for a file whose faces use these materials.
  std::vector<std::uint32_t> sized(const std::set<std::string>& materials) const;

 private:
  std::int32_t lod_of_named(std::string_view name);

  const NamedVoxelSizes* sizes_;
  std::int32_t of_material_ = not_stated, of_group_ = not_stated, of_object_ = not_stated;
  std::set<std::string> nodes_;  ///< names of nodes with a level that the file has
};

}  // namespace gigabake
