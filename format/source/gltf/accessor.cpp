#include "format/source/gltf/accessor.h"

#include <algorithm>
#include <cstring>

namespace gigabake {
namespace {

const unsigned char* view_data(const tinygltf::Model& model, int view, std::size_t offset) {
  const tinygltf::BufferView& v = model.bufferViews[std::size_t(view)];
  return model.buffers[std::size_t(v.buffer)].data.data() + v.byteOffset + offset;
}

template <class T>
T load(const unsigned char* from) {
  T v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

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

/// visit(item, address) for the dense items, then for the sparse ones that replace some of them.
template <class Visit>
void for_each_item(const tinygltf::Model& model, const tinygltf::Accessor& a, const Visit& visit) {
  const auto component = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(a.componentType)));
  const std::size_t packed = component * std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(a.type)));
  if (a.bufferView >= 0) {
    const std::size_t stride = model.bufferViews[std::size_t(a.bufferView)].byteStride;
    const unsigned char* from = view_data(model, a.bufferView, a.byteOffset);
    for (std::size_t i = 0; i < a.count; ++i) visit(i, from + i * (stride != 0 ? stride : packed));
  }
  if (!a.sparse.isSparse) return;
  const unsigned char* indices =
      view_data(model, a.sparse.indices.bufferView, std::size_t(a.sparse.indices.byteOffset));
  const unsigned char* values = view_data(model, a.sparse.values.bufferView, std::size_t(a.sparse.values.byteOffset));
  const auto index_bytes =
      std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(a.sparse.indices.componentType)));
  for (std::size_t i = 0; i < std::size_t(a.sparse.count); ++i) {
    const std::uint32_t item = index_at(indices + i * index_bytes, a.sparse.indices.componentType);
    if (item < a.count) visit(item, values + i * packed);
  }
}

}  // namespace

int component_count(const tinygltf::Model& model, int accessor) {
  return tinygltf::GetNumComponentsInType(std::uint32_t(model.accessors[std::size_t(accessor)].type));
}

float quantization_step(const tinygltf::Model& model, int accessor) {
  const tinygltf::Accessor& a = model.accessors[std::size_t(accessor)];
  if (a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return 0;
  if (!a.normalized) return 1;
  const std::int32_t one = 1;  // little-endian: the smallest positive value of any integer type
  return float_at(reinterpret_cast<const unsigned char*>(&one), a.componentType, true);
}

std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components, float missing) {
  const tinygltf::Accessor& a = model.accessors[std::size_t(accessor)];
  const int stored = std::min(components, component_count(model, accessor));
  const int bytes = tinygltf::GetComponentSizeInBytes(std::uint32_t(a.componentType));
  std::vector<float> out(a.count * std::size_t(components), stored < components ? missing : 0.0f);
  for_each_item(model, a, [&](std::size_t item, const unsigned char* from) {
    float* to = &out[item * std::size_t(components)];
    if (a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
      std::memcpy(to, from, std::size_t(stored) * sizeof(float));
    else
      for (int c = 0; c < stored; ++c) to[c] = float_at(from + c * bytes, a.componentType, a.normalized);
  });
  return out;
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor) {
  const tinygltf::Accessor& a = model.accessors[std::size_t(accessor)];
  std::vector<std::uint32_t> out;
  if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    return out;
  out.assign(a.count, 0);
  for_each_item(model, a,
                [&](std::size_t item, const unsigned char* from) { out[item] = index_at(from, a.componentType); });
  return out;
}

}  // namespace gigabake
