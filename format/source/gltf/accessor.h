/// Values of a checked glTF accessor, all or some of them: strided, normalized, sparse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/source/gltf/load.h"
#include "lattice/memory_limit.h"

namespace gigabake {

/// Reads from the accessor's bytes wherever these are, and only as far as what is asked for is spread.
/// Cost  A block of at most 256 KiB; of a sparse accessor all its values.
/// Errors  InputError of the file's: cut while it is read; sparse values beyond memory_limit().
class AccessorItems {
 public:
  AccessorItems(const std::filesystem::path& file, const GltfDocument& document, int accessor);

  std::uint64_t count() const { return count_; }
  int components() const { return components_; }
  /// Floats are not indices.
  bool is_index() const;
  /// Between neighbouring values of floats() where components are integers (KHR_mesh_quantization); 0 where they are
  /// floats, whose spacing follows the value.
  float quantization_step() const;

  /// `components` floats an item. Integers are normalized where the accessor says so, else taken as numbers. Components
  /// that the accessor lacks are `missing`.
  std::vector<float> floats(int components, float missing = 0) const;
  /// Of some items, ascending. Cost  Items that lie far apart are read one by one.
  std::vector<float> floats_of(std::span<const std::uint32_t> items, int components, float missing = 0) const;
  /// Scalars from item `first` on. Range  is_index().
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
