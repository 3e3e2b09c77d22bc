#include "format/sample/glb_writer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "lattice/error.h"

namespace gigabake::sample {
namespace {

using Json = nlohmann::ordered_json;

enum ComponentType { unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, float32 = 5126 };
enum Target { array_buffer = 34962, element_array_buffer = 34963 };

/// The binary chunk and the JSON lists that point into it.
class Binary {
 public:
  /// Appends `bytes` as a view that starts on a multiple of four. Returns the view's index.
  int add_view(const void* data, std::size_t size, int target) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target) view["target"] = target;
    views.push_back(view);
    const auto* begin = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
    return int(views.size()) - 1;
  }

  int add_accessor(int view, ComponentType component, bool normalized, std::size_t count, const char* type) {
    Json accessor{{"bufferView", view}, {"componentType", int(component)}, {"count", count}, {"type", type}};
    if (normalized) accessor["normalized"] = true;
    accessors.push_back(accessor);
    return int(accessors.size()) - 1;
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  Json views = Json::array(), accessors = Json::array();

 private:
  std::vector<std::uint8_t> bytes_;
};

template <class T>
int add_attribute(Binary& binary, const std::vector<T>& values, ComponentType component, const char* type, int width) {
  const int view = binary.add_view(values.data(), values.size() * sizeof(T), array_buffer);
  return binary.add_accessor(view, component, component != float32, values.size() / width, type);
}

int add_positions(Binary& binary, const std::vector<float>& position) {
  const int accessor = add_attribute(binary, position, float32, "VEC3", 3);
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < position.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], position[i]);
    high[i % 3] = std::max(high[i % 3], position[i]);
  }
  binary.accessors[accessor]["min"] = low;
  binary.accessors[accessor]["max"] = high;
  return accessor;
}

int add_indices(Binary& binary, const GlbMesh& mesh) {
  // 65535 itself is the restart value, which glTF forbids.
  if (mesh.vertices() > 65535) {
    const int view = binary.add_view(mesh.index.data(), mesh.index.size() * 4, element_array_buffer);
    return binary.add_accessor(view, unsigned_int, false, mesh.index.size(), "SCALAR");
  }
  const std::vector<std::uint16_t> narrow(mesh.index.begin(), mesh.index.end());
  const int view = binary.add_view(narrow.data(), narrow.size() * 2, element_array_buffer);
  return binary.add_accessor(view, unsigned_short, false, narrow.size(), "SCALAR");
}

Json primitive_of(Binary& binary, const GlbMesh& mesh) {
  Json attributes{{"POSITION", add_positions(binary, mesh.position)}};
  if (!mesh.uv.empty()) attributes["TEXCOORD_0"] = add_attribute(binary, mesh.uv, unsigned_short, "VEC2", 2);
  if (!mesh.rgba.empty()) attributes["COLOR_0"] = add_attribute(binary, mesh.rgba, unsigned_byte, "VEC4", 4);
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

void add_images(Json& gltf, Binary& binary, const std::vector<GlbImage>& images) {
  if (images.empty()) return;
  constexpr int clamp_to_edge = 33071, linear = 9729, linear_mipmap_linear = 9987;
  gltf["samplers"] = Json::array({{{"magFilter", linear},
                                   {"minFilter", linear_mipmap_linear},
                                   {"wrapS", clamp_to_edge},
                                   {"wrapT", clamp_to_edge}}});
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int view = binary.add_view(images[i].bytes.data(), images[i].bytes.size(), 0);
    gltf["images"].push_back({{"bufferView", view}, {"mimeType", images[i].mime}});
    gltf["textures"].push_back({{"sampler", 0}, {"source", i}});
  }
}

void append_word(std::vector<std::uint8_t>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(std::uint8_t(value >> shift));
}

std::vector<std::uint8_t> assemble(std::string text, const std::vector<std::uint8_t>& binary) {
  constexpr std::uint32_t magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t padded = (binary.size() + 3) / 4 * 4, total = 12 + 8 + text.size() + 8 + padded;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("a GLB holds at most 4 GiB and this one would need " + std::to_string(total) +
                     " bytes: ask for more tiles or a smaller texture");
  std::vector<std::uint8_t> out;
  out.reserve(total);
  append_word(out, magic);
  append_word(out, 2);
  append_word(out, total);
  append_word(out, text.size());
  append_word(out, json_chunk);
  out.insert(out.end(), text.begin(), text.end());
  append_word(out, padded);
  append_word(out, binary_chunk);
  out.insert(out.end(), binary.begin(), binary.end());
  out.resize(total, 0);
  return out;
}

}  // namespace

std::vector<std::uint8_t> to_glb(const GlbModel& model) {
  Binary binary;
  Json primitives = Json::array(), materials = Json::array();
  for (const GlbMesh& mesh : model.meshes)
    if (!mesh.index.empty()) primitives.push_back(primitive_of(binary, mesh));
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
  gltf["buffers"] = Json::array({{{"byteLength", binary.bytes().size()}}});
  return assemble(gltf.dump(), binary.bytes());
}

}  // namespace gigabake::sample
