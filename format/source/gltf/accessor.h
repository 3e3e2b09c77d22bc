/// Values of a checked glTF accessor, which may be strided, normalized or sparse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/memory_limit.h"
#include "format/source/gltf/load.h"

namespace gigabake {

/// Reader of an accessor's bytes, in memory or in the file. It reads only the range that a call requests.
/// Cost    Memory: a block of at most 256 KiB, or all values of a sparse accessor.
/// Errors  InputError: the file becomes shorter while it is read, or sparse values exceed memory_limit().
class AccessorItems {
 public:
  AccessorItems(const std::filesystem::path& file, const GltfDocument& document, int accessor);

  std::uint64_t count() const { return count_; }
  int components() const { return components_; }
  /// Returns whether the components are unsigned integers, as index components must be.
  bool is_index() const;
  /// Returns the distance between neighbouring values of floats() if components are integers (KHR_mesh_quantization).
  /// Returns 0 for floats, whose spacing depends on the value.
  float quantization_step() const;

  /// Returns `components` floats per item. Integers are normalized if the accessor requires it, else converted.
  /// Components that the accessor lacks are `missing`.
  std::vector<float> floats(int components, float missing = 0) const;
  /// Returns floats() of the items with the indices `items`, which must be in ascending order.
  /// Cost    Items that are far apart are read one by one.
  std::vector<float> floats_of(std::span<const std::uint32_t> items, int components, float missing = 0) const;
  /// Returns `count` scalars from item `first` on.
  /// Range   is_index().
  std::vector<std::uint32_t> indices(std::uint64_t first, std::uint64_t count) const;

 private:
  template <class ItemAt, class Visit>
  void for_each(std::size_t count, const ItemAt& item_at, const Visit& visit) const;
  template <class ItemAt>
  std::vector<float> read_floats(std::size_t count, const ItemAt& item_at, int components, float missing) const;
  void add_sparse(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Accessor& accessor);

  SourceBytes bytes_;  ///< from the first item on
  std::uint64_t count_, stride_ = 0, item_bytes_;
  int component_type_, components_;
  bool normalized_;
};

int component_count(const tinygltf::Model& model, int accessor);

}  // namespace gigabake
