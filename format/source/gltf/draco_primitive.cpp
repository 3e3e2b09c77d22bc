#include "format/source/gltf/draco_primitive.h"

#include <cstring>

#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {
namespace {

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// Appends the values as a buffer, a view and an accessor; returns the accessor.
template <class T>
int add_accessor(GltfDocument& document, const std::vector<T>& values, int type, int component) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  tinygltf::BufferView view;
  view.byteLength = bytes.size();
  view.buffer = document.add_buffer(std::move(bytes));
  tinygltf::Model& model = document.model;
  tinygltf::Accessor accessor;
  accessor.bufferView = int(model.bufferViews.size());
  accessor.type = type;
  accessor.componentType = component;
  accessor.count = values.size() / std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(type)));
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return int(model.accessors.size()) - 1;
}

float max_of(int component) {
  switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 65535;
    default:
      return 0;
  }
}

class Unpacker {
 public:
  Unpacker(const std::filesystem::path& file, const std::string& where, GltfDocument& document,
           tinygltf::Primitive& primitive, std::uint64_t max_triangles)
      : file_(file), where_(where), document_(document), primitive_(primitive), max_triangles_(max_triangles) {}

  void unpack() {
    const tinygltf::Value& own = primitive_.extensions.at(draco_extension);
    if (!own.Has("bufferView") || !own.Has("attributes")) fail("expected bufferView and attributes");
    const tinygltf::Value& ids = own.Get("attributes");
    for (const auto& [name, accessor] : primitive_.attributes)
      if (ids.Has(name)) request(name, accessor, ids.Get(name));
    const SourceBytes packed = document_.view_bytes(own.Get("bufferView").GetNumberAsInt()).in_memory();
    DracoMesh mesh = decode_draco(file_, where_, packed.span(), requested_, max_triangles_);
    for (std::size_t i = 0; i < names_.size(); ++i)
      primitive_.attributes[names_[i]] =
          add_accessor(document_, mesh.attributes[i], types_[i], TINYGLTF_COMPONENT_TYPE_FLOAT);
    primitive_.indices =
        add_accessor(document_, mesh.index, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    if (primitive_.mode == TINYGLTF_MODE_TRIANGLE_STRIP) primitive_.mode = TINYGLTF_MODE_TRIANGLES;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, where_, message); }

  void request(const std::string& name, int accessor, const tinygltf::Value& id) {
    const tinygltf::Accessor& a = document_.model.accessors[std::size_t(accessor)];
    const int components = tinygltf::GetNumComponentsInType(std::uint32_t(a.type));
    if (!id.IsInt() || id.GetNumberAsInt() < 0) fail("expected the number of an attribute at " + name);
    if (components < 1 || components > 4) fail(name + ": expected a scalar or a vector");
    names_.push_back(name);
    types_.push_back(a.type);
    requested_.push_back(
        {std::uint32_t(id.GetNumberAsInt()), std::uint32_t(components), a.normalized ? max_of(a.componentType) : 0});
  }

  const std::filesystem::path& file_;
  const std::string& where_;
  GltfDocument& document_;
  tinygltf::Primitive& primitive_;
  std::uint64_t max_triangles_;
  std::vector<std::string> names_;
  std::vector<int> types_;
  std::vector<DracoAttribute> requested_;
};

/// Returns whether the accessor has no buffer view, so that its items are packed or zero.
bool is_without_bytes(const tinygltf::Model& model, int accessor) {
  return model.accessors[std::size_t(accessor)].bufferView < 0;
}

void unpack_primitive(const std::filesystem::path& file, const std::string& where, tinygltf::Primitive& primitive,
                      GltfDocument& document) {
  const tinygltf::Model& model = document.model;
  if (!primitive.extensions.contains(draco_extension)) return;
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end() || !is_without_bytes(model, position->second)) {
    if (primitive.indices >= 0 && is_without_bytes(model, primitive.indices)) primitive.indices = -1;
    return;
  }
  if (primitive.indices < 0) throw InputError(file, where, "expected indices");
  // The accessor counts the indices of a list or strip. The packed indices are a list, so the count is an upper bound
  // of the number of triangles.
  const std::uint64_t max_triangles = model.accessors[std::size_t(primitive.indices)].count;
  Unpacker(file, where, document, primitive, max_triangles).unpack();
}

}  // namespace

void unpack_draco(const std::filesystem::path& file, GltfDocument& document) {
  for (std::size_t m = 0; m < document.model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = document.model.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const std::string where =
          "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "].extensions." + draco_extension;
      unpack_primitive(file, where, primitives[p], document);
    }
  }
}

}  // namespace gigabake
