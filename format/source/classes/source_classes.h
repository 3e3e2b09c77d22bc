/// The classes of a source: what a scene .json states about the class of its voxels (docs/format-sources.md,
/// "Classes").
///
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

#include "core/octree/octree.h"
#include "core/octree/parameters.h"
#include "format/system/json/json_members.h"

namespace gigabake {

struct SceneSources;
struct TileRef;

/// Classes from ids in glTF: class = id + add. The ids are an attribute of the vertices, one of the sets that
/// EXT_mesh_features lists for a primitive, or one of the sets that EXT_instance_features lists for a node.
/// Range   One of `attribute`, `feature_set` and `instance_set` is set.
struct ClassIds {
  std::string attribute = {};            ///< such as "_BATCHID", or empty
  std::optional<int> feature_set = {};   ///< index in featureIds of EXT_mesh_features
  std::optional<int> instance_set = {};  ///< index in featureIds of EXT_instance_features; 0 is BATCH_ID of an i3dm
  std::int64_t add = 0;                  ///< −max_id … max_class
};

/// Ids are below this number, so that attributes of floats have them exactly.
inline constexpr std::int64_t max_id = std::int64_t(1) << 24;

struct SourceClasses {
  struct OfMaterial {
    std::string name;
    VoxelClass voxel_class = no_class;
  };
  VoxelClass of_source = no_class;
  std::vector<OfMaterial> of_materials;  ///< by ascending name
  std::optional<ClassIds> ids;
  std::filesystem::path file;  ///< scene .json
  std::string key;             ///< the source's entry in it

  std::size_t names() const { return of_materials.size(); }
  /// Returns the index in of_materials; nullopt if no class is stated for the name.
  std::optional<std::size_t> find_material(std::string_view name) const;
  /// Throws the error of a source that does not fit its classes: UsageError with file, member and message.
  [[noreturn]] void refuse(const std::string& member, const std::string& message) const;
  /// Throws the error of a material's name that no tile of the source has.
  [[noreturn]] void refuse_unknown(std::size_t material) const;
};

/// Returns a class that is a member of an object; nullopt if it is absent.
/// Errors  UsageError with file and key: it is not a whole number from 0 to max_class.
std::optional<VoxelClass> class_in(const JsonMembers& members, const char* key);

/// Returns the classes that the members `class`, `class_of_material` and `class_from_ids` of a source state; null if
/// there are none.
/// Errors  UsageError with file and key: a class is not a whole number from 0 to max_class; a member is unknown.
std::shared_ptr<const SourceClasses> source_classes_of(const JsonMembers& source);

/// Returns the classes as a JSON object. Equal classes give equal text.
std::string to_json(const SourceClasses& classes);
/// Parses the text of to_json(). `file` and `key` are not part of it.
/// Errors  UsageError like source_classes_of().
SourceClasses source_classes_from_json(const std::string& text);

/// Returns whether ids of instances decide. `classes` may be null.
bool takes_instance_ids(const SourceClasses* classes);
/// Returns whether ids of primitives decide. `classes` may be null.
bool takes_primitive_ids(const SourceClasses* classes);
/// Returns the class of an id: id + add, or no_class for `null_id`, which is negative if there is none.
/// Range   classes.ids is set. `where` is for messages.
/// Errors  UsageError with file and key: the id is not a whole number below max_id, or id + add is not a class.
VoxelClass class_of_id(double id, double null_id, const SourceClasses& classes, const std::string& where);

/// Returns the class that is stated for a material's name; not_stated (mesh.h) if there is none. `classes` may be null.
std::int32_t class_of_material(const SourceClasses* classes, std::string_view name);
/// Returns TileMesh::classified of a file with materials of these names. `classes` may be null.
std::vector<std::uint32_t> classified_names(const SourceClasses* classes, const std::set<std::string>& names);
/// Checks that the source does not take classes from ids. For formats without ids.
/// Errors  UsageError with file and key.
void expect_no_ids(const TileRef& tile);

/// Sets parameters.classes to whether a source states classes or an edit states one.
/// Errors  The errors of check().
void set_classes(const SceneSources& sources, BakeParameters& parameters);

}  // namespace gigabake
