/// Ids of the vertices or texels of glTF primitives, from which a source takes classes: batch ids and feature ids.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/classes/id_texture.h"
#include "format/source/classes/source_classes.h"
#include "format/source/gltf/accessor.h"
#include "format/source/mesh.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// The ids of a primitive: an attribute of its vertices, the numbers of the vertices, or a texture.
class FeatureIds {
 public:
  /// Finds the ids that `classes` names. `where` is the path of the primitive, for messages. `classes` must outlive
  /// the object.
  /// Range   classes.ids is set.
  /// Errors  UsageError with the scene .json and the primitive: it has no such ids, not one per vertex, or a texture of
  ///         ids that cannot be used.
  FeatureIds(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Primitive& primitive,
             const std::string& where, const SourceClasses& classes, SourceWarnings& warnings);

  /// Returns the texture with the ids; null if the vertices have ids.
  const IdTextureSource* texture() const { return texture_ ? &*texture_ : nullptr; }
  /// Checks each texel of texture(), which must not be null. Counts an image with lossy compression.
  /// Errors  UsageError: the image cannot be decoded or has more than 8 bits per channel, or id + add of a texel is not
  ///         a class.
  void check_texels(const std::filesystem::path& file, const GltfDocument& document, SourceWarnings& warnings) const;
  /// Returns the attribute with the ids; null if the numbers of the vertices or texels are the ids.
  const AccessorItems* attribute() const { return attribute_ ? &*attribute_ : nullptr; }
  /// Returns the classes of ids. `ids` are values of attribute(). A null id has no class.
  /// Errors  UsageError: an id is not a whole number below max_id, or id + add is not a class.
  std::vector<VoxelClass> classes_of(std::span<const float> ids) const;
  /// Returns the classes of vertices whose numbers are their ids.
  /// Errors  UsageError like the other function.
  std::vector<VoxelClass> classes_of(std::span<const std::uint32_t> vertices) const;

 private:
  [[noreturn]] void refuse(const std::string& message) const;
  VoxelClass class_of(double id) const;

  const SourceClasses& classes_;
  std::string where_;
  std::optional<AccessorItems> attribute_;
  std::optional<IdTextureSource> texture_;
  double null_id_ = -1;
};

/// Counts a primitive with ids that no class is taken from.
void count_unused_ids(const tinygltf::Primitive& primitive, const std::string& where, SourceWarnings& warnings);

/// Splits a primitive by the classes of its triangles (Primitive::vertex_class), in ascending order of classes. A
/// triangle has the class of at least two of its vertices; else the lowest of the three, which is counted.
/// Exact   Triangles of a class keep their order.
std::vector<Primitive> split_by_class(Primitive&& whole, const std::string& where, SourceWarnings& warnings);

}  // namespace gigabake
