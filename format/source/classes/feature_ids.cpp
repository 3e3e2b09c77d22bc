#include "format/source/classes/feature_ids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "format/source/mesh_parts.h"

namespace gigabake {
namespace {

constexpr const char* features_extension = "EXT_mesh_features";

/// Returns a member that is a whole number of at least 0; nullopt if it is absent or has another value.
std::optional<double> number_in(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return std::nullopt;
  const double number = object.Get(key).GetNumberAsDouble();
  return number >= 0 && number == std::floor(number) ? std::optional(number) : std::nullopt;
}

VoxelClass class_of_triangle(const VoxelClass of_vertex[3], bool& is_mixed) {
  const auto [a, b, c] = std::array{of_vertex[0], of_vertex[1], of_vertex[2]};
  is_mixed = a != b || b != c;
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

}  // namespace

FeatureIds::FeatureIds(const std::filesystem::path& file, const GltfDocument& document,
                       const tinygltf::Primitive& primitive, const std::string& where, const SourceClasses& classes)
    : classes_(classes), where_(file.filename().string() + ": " + where) {
  std::string name = classes.ids->attribute;
  if (classes.ids->feature_set) {
    const tinygltf::Value& set = feature_set(primitive);
    if (set.IsObject() && set.Has("texture")) refuse("its feature ids are a texture, which is not read");
    null_id_ = number_in(set, "nullFeatureId").value_or(-1);
    const auto number = number_in(set, "attribute");
    if (!number && set.IsObject() && set.Has("attribute")) refuse("expected the number of an attribute of feature ids");
    if (!number) return;
    name = fmt::format("_FEATURE_ID_{}", std::int64_t(*number));
  }
  const auto attribute = primitive.attributes.find(name);
  if (attribute == primitive.attributes.end()) refuse("has no attribute " + name);
  attribute_.emplace(file, document, attribute->second);
  const std::uint64_t vertices = document.model.accessors[std::size_t(primitive.attributes.at("POSITION"))].count;
  if (attribute_->components() != 1) refuse(name + " has several numbers per vertex; expected one");
  if (attribute_->count() != vertices)
    refuse(fmt::format("{} has {} ids for {} vertices", name, attribute_->count(), vertices));
}

void FeatureIds::refuse(const std::string& message) const {
  classes_.refuse("class_from_ids", where_ + ": " + message);
}

/// Returns the entry of EXT_mesh_features that the classes name.
const tinygltf::Value& FeatureIds::feature_set(const tinygltf::Primitive& primitive) {
  const auto extension = primitive.extensions.find(features_extension);
  if (extension == primitive.extensions.end()) refuse(std::string("has no ") + features_extension);
  const auto set = std::size_t(*classes_.ids->feature_set);
  const tinygltf::Value& sets = extension->second.Get("featureIds");
  if (!sets.IsArray() || set >= sets.ArrayLen()) refuse(fmt::format("{} has no set {}", features_extension, set));
  return sets.Get(set);
}

VoxelClass FeatureIds::class_of(double id) const {
  if (!(id >= 0 && id < double(max_id)) || id != std::floor(id))
    refuse(fmt::format("the id {:g} is not a whole number from 0 to {}", id, max_id - 1));
  if (id == null_id_) return no_class;
  const std::int64_t sum = std::int64_t(id) + classes_.ids->add;
  if (sum < 0 || sum > std::int64_t(max_class))
    refuse(
        fmt::format("the id {} + {} is not a class; expected 0 to {}", std::int64_t(id), classes_.ids->add, max_class));
  return VoxelClass(sum);
}

std::vector<VoxelClass> FeatureIds::classes_of(std::span<const float> ids) const {
  std::vector<VoxelClass> out;
  out.reserve(ids.size());
  for (const float id : ids) out.push_back(class_of(id));
  return out;
}

std::vector<VoxelClass> FeatureIds::classes_of(std::span<const std::uint32_t> vertices) const {
  std::vector<VoxelClass> out;
  out.reserve(vertices.size());
  for (const std::uint32_t vertex : vertices) out.push_back(class_of(vertex));
  return out;
}

void count_unused_ids(const tinygltf::Primitive& primitive, const std::string& where, SourceWarnings& warnings) {
  const auto is_id = [](const auto& attribute) {
    return attribute.first == "_BATCHID" || attribute.first.starts_with("_FEATURE_ID_");
  };
  if (std::ranges::any_of(primitive.attributes, is_id) || primitive.extensions.contains(features_extension))
    warnings.count("primitives with ids that are not used (class_from_ids of a scene .json)", where);
}

std::vector<Primitive> split_by_class(Primitive&& whole, const std::string& where, SourceWarnings& warnings) {
  std::map<VoxelClass, std::vector<std::uint32_t>> corners;
  for (std::size_t at = 0; at < whole.index.size(); at += 3) {
    VoxelClass of_vertex[3];
    for (std::size_t c = 0; c < 3; ++c) of_vertex[c] = whole.vertex_class[whole.index[at + c]];
    bool is_mixed = false;
    std::vector<std::uint32_t>& to = corners[class_of_triangle(of_vertex, is_mixed)];
    to.insert(to.end(), &whole.index[at], &whole.index[at] + 3);
    if (is_mixed)
      warnings.count("triangles whose vertices have different ids; two equal ids win, else the lowest", where);
  }
  std::vector<Primitive> out;
  if (corners.size() <= 1) {
    if (!corners.empty()) whole.voxel_class = corners.begin()->first;
    whole.vertex_class = {};
    out.push_back(std::move(whole));
    return out;
  }
  std::vector<std::uint32_t> vertices;
  for (auto& [voxel_class, index] : corners) {
    out.push_back(with_corners(whole, std::move(index), vertices));
    out.back().voxel_class = voxel_class;
  }
  return out;
}

}  // namespace gigabake
