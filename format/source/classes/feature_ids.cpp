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

VoxelClass class_of_triangle(const VoxelClass of_vertex[3], bool& is_mixed) {
  const auto [a, b, c] = std::array{of_vertex[0], of_vertex[1], of_vertex[2]};
  is_mixed = a != b || b != c;
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

}  // namespace

FeatureIds::FeatureIds(const std::filesystem::path& file, const GltfDocument& document,
                       const tinygltf::Primitive& primitive, const std::string& where, const SourceClasses& classes,
                       SourceWarnings& warnings)
    : classes_(classes), where_(file.filename().string() + ": " + where) {
  const RefuseIds refuse_ids = [this](const std::string& message) { refuse(message); };
  std::string name = classes.ids->attribute;
  if (classes.ids->feature_set) {
    const tinygltf::Value& set =
        id_set(primitive.extensions, features_extension, *classes.ids->feature_set, refuse_ids);
    null_id_ = null_id_of(set);
    if (set.IsObject() && set.Has("texture")) {
      texture_.emplace(id_texture(file, document, primitive, set.Get("texture"), refuse_ids, warnings));
      texture_->ids.null_id = null_id_ < double(max_id) ? std::int32_t(null_id_) : -1;
      texture_->ids.add = std::int32_t(classes.ids->add);
      return;
    }
    const auto of_set = id_attribute(set, refuse_ids);
    if (!of_set) return;
    name = *of_set;
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

void FeatureIds::check_texels(const std::filesystem::path& file, const GltfDocument& document,
                              SourceWarnings& warnings) const {
  const auto refuse_ids = [this](const std::string& message) { refuse(message); };
  gigabake::check_texels(file, document, *texture_, refuse_ids, warnings);
}

VoxelClass FeatureIds::class_of(double id) const { return class_of_id(id, null_id_, classes_, where_); }

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
