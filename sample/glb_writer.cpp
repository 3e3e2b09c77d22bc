#include "sample/glb_writer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace gigabake::sample {
namespace {

using Json = nlohmann::ordered_json;

enum ComponentType { unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, float32 = 5126 };
enum Target { array_buffer = 34962, element_array_buffer = 34963 };

using PutBytes = GlbPut<std::uint8_t>;

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

/// The JSON lists that refer to the binary chunk, and the functions that write its content.
class Binary {
 public:
  /// Appends `size` bytes as a view that starts on a multiple of four. Returns the view's index.
  int add_view(std::size_t size, int target, std::function<void(const PutBytes&)> write) {
    bytes_ = (bytes_ + 3) / 4 * 4;
    Json view{{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", size}};
    if (target) view["target"] = target;
    views.push_back(view);
    writers_.push_back({bytes_, std::move(write)});
    bytes_ += size;
    return int(views.size()) - 1;
  }

  int add_accessor(int view, ComponentType component, bool normalized, std::size_t count, const char* type) {
    Json accessor{{"bufferView", view}, {"componentType", int(component)}, {"count", count}, {"type", type}};
    if (normalized) accessor["normalized"] = true;
    accessors.push_back(accessor);
    return int(accessors.size()) - 1;
  }

  std::size_t bytes() const { return bytes_; }

  /// Writes all views, with zero padding between them and up to `end`.
  void write(std::size_t end, const PutBytes& put) const {
    std::size_t at = 0;
    const PutBytes pluralize = [&](std::span<const std::uint8_t> piece) {
      put(piece);
      at += piece.size();
    };
    const auto fill_to = [&](std::size_t offset) { pluralize(std::vector<std::uint8_t>(offset - at)); };
    for (const auto& [offset, write_view] : writers_) {
      fill_to(offset);
      write_view(pluralize);
    }
    fill_to(end);
  }

  Json views = Json::array(), accessors = Json::array();

 private:
  struct Writer {
    std::size_t offset;
    std::function<void(const PutBytes&)> write;
  };
  std::size_t bytes_ = 0;
  std::vector<Writer> writers_;
};

template <class T>
int add_attribute(Binary& binary, const GlbList<T>& list, std::size_t count, ComponentType component, const char* type,
                  std::size_t width) {
  const int view = binary.add_view(count * width * sizeof(T), array_buffer, [list](const PutBytes& put) {
    list([&](std::span<const T> values) { put(bytes_of(values)); });
  });
  return binary.add_accessor(view, component, component != float32, count, type);
}

int add_positions(Binary& binary, const GlbListedMesh& mesh) {
  const int accessor = add_attribute(binary, mesh.position, mesh.vertices, float32, "VEC3", 3);
  binary.accessors[accessor]["min"] = mesh.low;
  binary.accessors[accessor]["max"] = mesh.high;
  return accessor;
}

int add_indices(Binary& binary, const GlbListedMesh& mesh) {
  // Index 65535 is the restart value, which glTF forbids.
  const bool is_wide = mesh.vertices > 65535;
  const auto write = [list = mesh.index, is_wide](const PutBytes& put) {
    list([&](std::span<const std::uint32_t> values) {
      if (is_wide) return put(bytes_of(values));
      const std::vector<std::uint16_t> narrow(values.begin(), values.end());
      put(bytes_of(std::span(narrow)));
    });
  };
  const int view = binary.add_view(mesh.corners * (is_wide ? 4 : 2), element_array_buffer, write);
  return binary.add_accessor(view, is_wide ? unsigned_int : unsigned_short, false, mesh.corners, "SCALAR");
}

Json primitive_of(Binary& binary, const GlbListedMesh& mesh) {
  Json attributes{{"POSITION", add_positions(binary, mesh)}};
  if (mesh.uv) attributes["TEXCOORD_0"] = add_attribute(binary, mesh.uv, mesh.vertices, unsigned_short, "VEC2", 2);
  if (mesh.rgba) attributes["COLOR_0"] = add_attribute(binary, mesh.rgba, mesh.vertices, unsigned_byte, "VEC4", 4);
  const int indices = add_indices(binary, mesh);
  return {{"attributes", attributes}, {"indices", indices}, {"material", mesh.material}};
}

Json material_of(const GlbMaterial& material) {
  Json pbr{{"baseColorFactor", material.base_color}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
  if (material.image >= 0) pbr["baseColorTexture"] = {{"index", material.image}};
  Json json{{"name", material.name}, {"pbrMetallicRoughness", pbr}};
  if (material.alpha_cutoff > 0) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  }
  if (material.blended) json["alphaMode"] = "BLEND";
  if (material.double_sided) json["doubleSided"] = true;
  return json;
}

Json image_of(Binary& binary, const GlbImage& image) {
  if (!image.uri.empty()) return {{"uri", image.uri}};
  const int view = binary.add_view(image.bytes.size(), 0, [&bytes = image.bytes](const PutBytes& put) { put(bytes); });
  return {{"bufferView", view}, {"mimeType", image.mime}};
}

void add_images(Json& gltf, Binary& binary, const std::vector<GlbImage>& images) {
  if (images.empty()) return;
  constexpr int clamp_to_edge = 33071, linear = 9729, linear_mipmap_linear = 9987;
  gltf["samplers"] = Json::array({{{"magFilter", linear},
                                   {"minFilter", linear_mipmap_linear},
                                   {"wrapS", clamp_to_edge},
                                   {"wrapT", clamp_to_edge}}});
  for (std::size_t i = 0; i < images.size(); ++i) {
    gltf["images"].push_back(image_of(binary, images[i]));
    gltf["textures"].push_back({{"sampler", 0}, {"source", i}});
  }
}

void append_word(std::vector<std::uint8_t>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(std::uint8_t(value >> shift));
}

void assemble(std::string text, const Binary& binary, const PutBytes& put) {
  constexpr std::uint32_t magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t padded = (binary.bytes() + 3) / 4 * 4, total = 12 + 8 + text.size() + 8 + padded;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("a GLB holds at most 4 GiB, but this one would need " + std::to_string(total) +
                     " bytes: use more tiles or a smaller texture");
  std::vector<std::uint8_t> head;
  append_word(head, magic);
  append_word(head, 2);
  append_word(head, total);
  append_word(head, text.size());
  append_word(head, json_chunk);
  head.insert(head.end(), text.begin(), text.end());
  append_word(head, padded);
  append_word(head, binary_chunk);
  put(head);
  binary.write(padded, put);
}

template <class T>
GlbList<T> list_of(const std::vector<T>& values) {
  if (values.empty()) return {};
  return [&values](const GlbPut<T>& put) { put(values); };
}

/// Returns the mesh as lists. The mesh must outlive the lists.
GlbListedMesh listed(const GlbMesh& mesh) {
  GlbListedMesh out{mesh.material, mesh.vertices(), mesh.index.size(), {}, {}, {}, {}, {}, {}};
  out.low.fill(std::numeric_limits<float>::max());
  out.high.fill(std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < mesh.position.size(); ++i) {
    out.low[i % 3] = std::min(out.low[i % 3], mesh.position[i]);
    out.high[i % 3] = std::max(out.high[i % 3], mesh.position[i]);
  }
  out.position = list_of(mesh.position);
  out.uv = list_of(mesh.uv);
  out.rgba = list_of(mesh.rgba);
  out.index = list_of(mesh.index);
  return out;
}

}  // namespace

void write_glb(const GlbModel& model, std::span<const GlbListedMesh> meshes, const GlbPut<std::uint8_t>& put) {
  Binary binary;
  Json primitives = Json::array(), materials = Json::array();
  for (const GlbListedMesh& mesh : meshes)
    if (mesh.corners != 0) primitives.push_back(primitive_of(binary, mesh));
  for (const GlbMaterial& material : model.materials) materials.push_back(material_of(material));
  Json gltf{{"asset", {{"version", "2.0"}, {"generator", "gigabake sample"}}}, {"scene", 0}};
  gltf["scenes"] = Json::array({{{"nodes", {0}}}});
  Json node{{"name", model.name}, {"mesh", 0}};
  if (model.translation_m != std::array<double, 3>{}) node["translation"] = model.translation_m;
  gltf["nodes"] = Json::array({node});
  gltf["meshes"] = Json::array({{{"name", model.name}, {"primitives", primitives}}});
  gltf["materials"] = materials;
  add_images(gltf, binary, model.images);
  gltf["accessors"] = binary.accessors;
  gltf["bufferViews"] = binary.views;
  gltf["buffers"] = Json::array({{{"byteLength", binary.bytes()}}});
  assemble(gltf.dump(), binary, put);
}

std::vector<std::uint8_t> to_glb(const GlbModel& model) {
  std::vector<GlbListedMesh> meshes;
  for (const GlbMesh& mesh : model.meshes) meshes.push_back(listed(mesh));
  std::vector<std::uint8_t> out;
  write_glb(model, meshes,
            [&](std::span<const std::uint8_t> bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); });
  return out;
}

}  // namespace gigabake::sample
