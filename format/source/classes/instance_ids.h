/// Ids of the instances of a mesh, from which a source takes classes: EXT_instance_features of glTF, BATCH_ID of i3dm.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/classes/source_classes.h"
#include "format/source/gltf/load.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// Returns the classes of a node's instances.
/// Range   takes_instance_ids(&classes). `where` is the path of the node, for messages.
/// Errors  UsageError with the scene .json and the node: it has no such ids, not one per instance, or an id that
///         class_of_id() refuses.
std::vector<VoxelClass> classes_of_instances(const std::filesystem::path& file, const GltfDocument& document,
                                             const tinygltf::Node& node, const std::string& where,
                                             std::size_t instances, const SourceClasses& classes);

/// Returns the classes of the instances of an i3dm.
/// Range   takes_instance_ids(&classes).
/// Errors  UsageError with the scene .json and the file: `classes` names another set than 0, or class_of_id() refuses
///         an id.
std::vector<VoxelClass> classes_of_i3dm(const std::filesystem::path& file, std::span<const std::uint32_t> ids,
                                        const SourceClasses& classes);

/// Counts a node whose instances have ids, for a source that does not use them.
void count_unused_instance_ids(const tinygltf::Node& node, const std::string& where, SourceWarnings& warnings);

/// Text of the warning about instances with ids in a source that does not use them.
inline constexpr const char* unused_instance_ids =
    "nodes or tiles whose instances have ids that are not used (class_from_ids of a scene .json)";

}  // namespace gigabake
