/// The voxel sizes that a scene .json states for names of materials and nodes of a source.
///
/// A triangle has the size of its material's name. Without one, it has the size of its node, or of the nearest node
/// above it that has one; else the size of the source.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/system/json/json_members.h"

namespace gigabake {

struct NamedVoxelSizes {
  struct OfName {
    std::string name;
    SourceVoxelSize size;
    std::uint8_t lod = 0;  ///< level of the size; see set_source_levels() (source_levels.h)
  };
  std::vector<OfName> of_materials, of_nodes;  ///< by ascending name
  std::filesystem::path file;                  ///< scene .json
  std::string key;                             ///< the source's entry in it

  /// Returns how many names there are. Names are numbered: first the materials, then the nodes.
  std::size_t names() const { return of_materials.size() + of_nodes.size(); }
  /// Returns whether a name has another level than 0.
  bool has_coarse() const;
  /// Throws the error of a name that no tile of the source has: UsageError with file, member and name.
  [[noreturn]] void refuse_unknown(std::size_t name) const;
};

/// Returns the sizes that the members `voxel_size_of_material` and `voxel_size_of_node` of a source state; null if
/// there are none.
/// Errors  UsageError with file and key: a size is not a number from 1e-6 to 1e6.
std::shared_ptr<const NamedVoxelSizes> named_voxel_sizes_of(const JsonMembers& source);

/// Returns the level that is stated for a name of a material or node; not_stated (mesh.h) if there is none. `sizes` may
/// be null.
std::int32_t lod_of_material(const NamedVoxelSizes* sizes, std::string_view name);
std::int32_t lod_of_node(const NamedVoxelSizes* sizes, std::string_view name);
/// Returns the level at which a placement's triangles are voxelized. The tile's level applies if the placement has
/// none.
inline int lod_of(const Instance& instance, const TileRef& tile) {
  return instance.lod == not_stated ? int(tile.lod) : int(instance.lod);
}
/// Returns whether some triangles of the tile may be voxelized at another level than 0.
bool may_have_levels(const TileRef& tile);

/// Returns TileMesh::sized of a file that has these names. `sizes` may be null.
std::vector<std::uint32_t> sized_names(const NamedVoxelSizes* sizes, const std::set<std::string>& materials,
                                       const std::set<std::string>& nodes);
/// Checks that the source does not state sizes of nodes. For formats without nodes.
/// Errors  UsageError with file and key.
void expect_no_nodes(const TileRef& tile);

/// Returns the names and their levels as a JSON object. Equal levels give equal text.
std::string to_json(const NamedVoxelSizes& sizes);
/// Returns the same of the names that a file has; empty if it has none.
std::string to_json(const NamedVoxelSizes& sizes, const std::set<std::string>& materials,
                    const std::set<std::string>& nodes);
/// Parses the text of to_json(). `file`, `key` and the sizes are not part of it.
/// Errors  UsageError: the text is malformed, or a level is not a whole number from 0 to max_source_lod.
NamedVoxelSizes named_voxel_sizes_from_json(const std::string& text);

}  // namespace gigabake
