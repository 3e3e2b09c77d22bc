#include "format/source/gltf/accessor.h"

#include <algorithm>
#include <cstring>

namespace gigabake {
namespace {

/// Max gap between two items that one read covers. Reading the bytes of the gap costs less than another system call.
constexpr std::uint64_t max_gap_bytes = std::uint64_t(1) << 14;

template <class T>
T load(const unsigned char* from) {
  T v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

/// Returns a component as a float. Divides a normalized integer by the max value of its type; the result is at least
/// -1.
/// Source  glTF 2.0, 3.6.2.2 (normalized integers).
float float_at(const unsigned char* from, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float v = load<std::int8_t>(from);
      return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(from) / (normalized ? 255.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float v = load<std::int16_t>(from);
      return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(from) / (normalized ? 65535.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return float(load<std::uint32_t>(from));
    default:
      return load<float>(from);
  }
}

std::uint32_t index_at(const unsigned char* from, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(from);
    default:
      return load<std::uint32_t>(from);
  }
}

std::uint64_t bytes_of_component(int type) {
  return std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type)));
}

/// Returns `bytes` bytes of a view from `offset` on.
SourceBytes piece(const GltfDocument& document, int view, std::uint64_t offset, std::uint64_t bytes) {
  return document.view_bytes(view).part(offset, bytes);
}

}  // namespace

int component_count(const tinygltf::Model& model, int accessor) {
  return tinygltf::GetNumComponentsInType(std::uint32_t(model.accessors[std::size_t(accessor)].type));
}

AccessorItems::AccessorItems(const std::filesystem::path& file, const GltfDocument& document, int accessor) {
  const tinygltf::Accessor& a = document.model.accessors[std::size_t(accessor)];
  count_ = a.count;
  component_type_ = a.componentType;
  normalized_ = a.normalized;
  components_ = component_count(document.model, accessor);
  item_bytes_ = bytes_of_component(component_type_) * std::uint64_t(components_);
  if (a.bufferView >= 0) {
    const std::uint64_t stride = document.model.bufferViews[std::size_t(a.bufferView)].byteStride;
    stride_ = stride != 0 ? stride : item_bytes_;
    bytes_ = piece(document, a.bufferView, a.byteOffset, count_ == 0 ? 0 : (count_ - 1) * stride_ + item_bytes_);
  } else {
    bytes_ = SourceBytes(std::vector<std::uint8_t>(item_bytes_));  // stride 0: every item is this item of zeros
  }
  if (a.sparse.isSparse) add_sparse(file, document, a);
}

/// Reads all items into memory, and replaces the items that the sparse accessor lists.
void AccessorItems::add_sparse(const std::filesystem::path& file, const GltfDocument& document,
                               const tinygltf::Accessor& a) {
  const auto replaced = std::uint64_t(a.sparse.count);
  const int type = a.sparse.indices.componentType;
  const std::uint64_t index_bytes = bytes_of_component(type);
  MemoryClaim claim(file);
  claim.add_items(count_, item_bytes_, "accessors", "items of a sparse accessor");
  claim.add_items(replaced, index_bytes + item_bytes_, "accessors", "items of a sparse accessor");
  std::vector<std::uint8_t> plain(count_ * item_bytes_);
  for_each(
      count_, [](std::size_t i) { return i; },
      [&](std::size_t i, const unsigned char* from) { std::memcpy(&plain[i * item_bytes_], from, item_bytes_); });
  const std::vector<std::uint8_t> indices = piece(document, a.sparse.indices.bufferView,
                                                  std::uint64_t(a.sparse.indices.byteOffset), replaced * index_bytes)
                                                .copy(),
                                  values = piece(document, a.sparse.values.bufferView,
                                                 std::uint64_t(a.sparse.values.byteOffset), replaced * item_bytes_)
                                               .copy();
  for (std::uint64_t i = 0; i < replaced; ++i) {
    const std::uint32_t item = index_at(&indices[i * index_bytes], type);
    if (item < count_) std::memcpy(&plain[item * item_bytes_], &values[i * item_bytes_], item_bytes_);
  }
  bytes_ = SourceBytes(std::move(plain));
  stride_ = item_bytes_;
}

bool AccessorItems::is_index() const {
  return component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

float AccessorItems::quantization_step() const {
  if (component_type_ == TINYGLTF_COMPONENT_TYPE_FLOAT) return 0;
  if (!normalized_) return 1;
  const std::int32_t one = 1;  // little-endian: the smallest positive value of any integer type
  return float_at(reinterpret_cast<const unsigned char*>(&one), component_type_, true);
}

/// Calls visit(i, address of item item_at(i)) for each i below `count`. item_at() must be ascending.
template <class ItemAt, class Visit>
void AccessorItems::for_each(std::size_t count, const ItemAt& item_at, const Visit& visit) const {
  std::vector<std::uint8_t> buffer;
  for (std::size_t i = 0; i < count;) {
    const std::uint64_t begin = item_at(i) * stride_;
    std::uint64_t last = begin;
    std::size_t end = i + 1;
    for (; end < count; ++end) {
      const std::uint64_t next = item_at(end) * stride_;
      if (next - last > max_gap_bytes || next + item_bytes_ - begin > read_block_bytes) break;
      last = next;
    }
    const unsigned char* block = bytes_.look(begin, last + item_bytes_ - begin, buffer).data();
    for (; i < end; ++i) visit(i, block + (item_at(i) * stride_ - begin));
  }
}

template <class ItemAt>
std::vector<float> AccessorItems::read_floats(std::size_t count, const ItemAt& item_at, int components,
                                              float missing) const {
  const int stored = std::min(components, components_);
  const std::uint64_t component_bytes = bytes_of_component(component_type_);
  const auto width = std::size_t(components);
  std::vector<float> out(count * width, stored < components ? missing : 0.0f);
  const bool is_float = component_type_ == TINYGLTF_COMPONENT_TYPE_FLOAT;
  if (is_float && stored == 3)  // the positions of almost all files
    for_each(count, item_at,
             [&](std::size_t i, const unsigned char* from) { std::memcpy(&out[i * width], from, 3 * sizeof(float)); });
  else
    for_each(count, item_at, [&](std::size_t i, const unsigned char* from) {
      for (int c = 0; c < stored; ++c)
        out[i * width + std::size_t(c)] =
            float_at(from + std::uint64_t(c) * component_bytes, component_type_, normalized_);
    });
  return out;
}

std::vector<float> AccessorItems::floats(int components, float missing) const {
  return read_floats(
      count_, [](std::size_t i) { return std::uint64_t(i); }, components, missing);
}

std::vector<float> AccessorItems::floats_of(std::span<const std::uint32_t> items, int components, float missing) const {
  return read_floats(
      items.size(), [items](std::size_t i) { return std::uint64_t(items[i]); }, components, missing);
}

std::vector<std::uint32_t> AccessorItems::indices(std::uint64_t first, std::uint64_t count) const {
  std::vector<std::uint32_t> out(count);
  for_each(
      count, [first](std::size_t i) { return first + i; },
      [&](std::size_t i, const unsigned char* from) { out[i] = index_at(from, component_type_); });
  return out;
}

}  // namespace gigabake
