#include "format/source/classes/instance_ids.h"

#include <fmt/format.h>
#include <optional>

#include "format/source/classes/id_set.h"
#include "format/source/gltf/accessor.h"

namespace gigabake {
namespace {

constexpr const char* instances_extension = "EXT_instance_features";

/// Returns the attribute of a node's instances; nullopt if the numbers of the instances are the ids.
std::optional<AccessorItems> attribute_of(const std::filesystem::path& file, const GltfDocument& document,
                                          const tinygltf::Node& node, const tinygltf::Value& set,
                                          const RefuseIds& refuse) {
  const auto name = id_attribute(set, refuse);
  if (!name) return std::nullopt;
  const auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
  if (instancing == node.extensions.end() || !instancing->second.Get("attributes").Has(*name))
    refuse("EXT_mesh_gpu_instancing has no attribute " + *name);
  return AccessorItems(file, document, instancing->second.Get("attributes").Get(*name).GetNumberAsInt());
}

}  // namespace

std::vector<VoxelClass> classes_of_instances(const std::filesystem::path& file, const GltfDocument& document,
                                             const tinygltf::Node& node, const std::string& where,
                                             std::size_t instances, const SourceClasses& classes) {
  const std::string in_file = file.filename().string() + ": " + where;
  const RefuseIds refuse = [&](const std::string& message) {
    classes.refuse("class_from_ids", in_file + ": " + message);
  };
  const tinygltf::Value& set = id_set(node.extensions, instances_extension, *classes.ids->instance_set, refuse);
  const double null_id = null_id_of(set);
  const std::optional<AccessorItems> attribute = attribute_of(file, document, node, set, refuse);
  std::vector<float> of_instance;
  if (attribute) {
    if (attribute->components() != 1) refuse("its ids have several numbers per instance; expected one");
    if (attribute->count() != instances)
      refuse(fmt::format("has {} ids for {} instances", attribute->count(), instances));
    of_instance = attribute->floats(1);
  }
  std::vector<VoxelClass> out;
  out.reserve(instances);
  for (std::size_t i = 0; i < instances; ++i)
    out.push_back(class_of_id(attribute ? double(of_instance[i]) : double(i), null_id, classes, in_file));
  return out;
}

std::vector<VoxelClass> classes_of_i3dm(const std::filesystem::path& file, std::span<const std::uint32_t> ids,
                                        const SourceClasses& classes) {
  const std::string where = file.filename().string() + ": BATCH_ID";
  if (*classes.ids->instance_set != 0)
    classes.refuse("class_from_ids",
                   fmt::format("{}: an i3dm has set 0 only, not set {}", where, *classes.ids->instance_set));
  std::vector<VoxelClass> out;
  out.reserve(ids.size());
  for (const std::uint32_t id : ids) out.push_back(class_of_id(id, -1, classes, where));
  return out;
}

void count_unused_instance_ids(const tinygltf::Node& node, const std::string& where, SourceWarnings& warnings) {
  if (node.extensions.contains(instances_extension)) warnings.count(unused_instance_ids, where);
}

}  // namespace gigabake
