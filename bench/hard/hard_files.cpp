// write_scene(): a hard scene as 3D Tiles 1.0 with binary glTF.
#include <nlohmann/json.hpp>

#include "bench/hard/hard_scene.h"
#include "core/base/error.h"
#include "format/system/publish.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double reach_m = 1000;  ///< half edge of bounding volumes; a bake reads only the centre of the root's volume
constexpr int byte_type = 5121, short_type = 5123, int_type = 5125, float_type = 5126;

template <class To, class From>
Json columns_of(const Affine<To, From>& map) {
  Json out = Json::array();
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t r = 0; r < 3; ++r) out.push_back(map.m[r][c]);
    out.push_back(c == 3 ? 1 : 0);
  }
  return out;
}

/// A GLB file: JSON and a binary chunk to which accessors are appended.
class GlbFile {
 public:
  explicit GlbFile(const HardTile& tile) {
    json_ = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", Json::array()}}}}};
    for (const Image& image : tile.images) add_image(image);
    for (const HardMaterial& material : tile.materials) add_material(material);
    for (const HardMesh& mesh : tile.meshes) add_mesh(mesh);
    for (const HardNode& node : tile.nodes) {
      json_["scenes"][0]["nodes"].push_back(json_.contains("nodes") ? json_["nodes"].size() : 0);
      json_["nodes"].push_back({{"mesh", node.mesh}, {"matrix", columns_of(node.map)}});
    }
    if (!binary_.empty()) json_["buffers"] = {{{"byteLength", binary_.size()}}};
  }

  std::string bytes() {
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary_.resize((binary_.size() + 3) / 4 * 4);
    std::string out = "glTF";
    const auto put = [&out](std::size_t v) {
      const auto word = std::uint32_t(v);
      out.append(reinterpret_cast<const char*>(&word), 4);
    };
    put(2), put(12 + 8 + text.size() + 8 + binary_.size());
    put(text.size()), put(0x4E4F534A), out += text;
    put(binary_.size()), put(0x004E4942), out += binary_;
    return out;
  }

 private:
  std::size_t add_view(const void* data, std::size_t bytes) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}});
    binary_.append(static_cast<const char*>(data), bytes);
    return json_["bufferViews"].size() - 1;
  }

  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, int component, const char* type, std::size_t items) {
    const std::size_t view = add_view(values.data(), values.size() * sizeof(T));
    json_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", items}, {"type", type}});
    return json_["accessors"].size() - 1;
  }

  std::size_t add_indices(const HardMesh& mesh) {
    if (mesh.position.size() / 3 > 255) return add_accessor(mesh.index, int_type, "SCALAR", mesh.index.size());
    const std::vector<std::uint8_t> narrow(mesh.index.begin(), mesh.index.end());
    return add_accessor(narrow, byte_type, "SCALAR", narrow.size());
  }

  void add_mesh(const HardMesh& mesh) {
    const std::size_t vertices = mesh.position.size() / 3;
    Json attributes = {{"POSITION", add_accessor(mesh.position, float_type, "VEC3", vertices)}};
    if (!mesh.uv.empty()) attributes["TEXCOORD_0"] = add_accessor(mesh.uv, float_type, "VEC2", vertices);
    if (!mesh.rgba.empty()) {
      attributes["COLOR_0"] = add_accessor(mesh.rgba, short_type, "VEC4", vertices);
      json_["accessors"].back()["normalized"] = true;
    }
    const std::size_t indices = add_indices(mesh);
    json_["meshes"].push_back(
        {{"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", mesh.material}}}}});
  }

  void add_image(const Image& image) {
    Picture picture;
    picture.width = image.width;
    picture.height = image.height;
    picture.rgba = image.rgba;
    const std::string png = encode_png(picture);
    const std::size_t view = add_view(png.data(), png.size());
    json_["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    json_["textures"].push_back({{"source", json_["images"].size() - 1}, {"sampler", 0}});
    json_["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};  // clamp to the edge
  }

  void add_material(const HardMaterial& material) {
    Json base = Json::array();
    for (const std::uint16_t c : material.base) base.push_back(c / 65535.0);
    Json pbr = {{"baseColorFactor", base}};
    if (material.image >= 0) pbr["baseColorTexture"] = {{"index", material.image}};
    json_["materials"].push_back({{"pbrMetallicRoughness", pbr}, {"alphaMode", name_of(material.mode)}});
  }

  Json json_;
  std::string binary_;
};

}  // namespace

std::filesystem::path write_scene(const std::filesystem::path& folder, const HardScene& scene) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder, "", "cannot make the folder: " + error.message());
  Json children = Json::array();
  const Json volume = {{"box", {0, 0, 0, reach_m, 0, 0, 0, reach_m, 0, 0, 0, reach_m}}};
  for (std::size_t i = 0; i < scene.tiles.size(); ++i) {
    const std::string name = "tile" + std::to_string(i) + ".glb";
    publish_file(folder / name, GlbFile(scene.tiles[i]).bytes(), Durability::while_up);
    children.push_back({{"boundingVolume", volume},
                        {"geometricError", 0},
                        {"content", {{"uri", name}}},
                        {"transform", columns_of(scene.tiles[i].transform)}});
  }
  // The middle of the root's volume defines the position of the tileset.
  Json root = {{"boundingVolume", volume}, {"geometricError", 1}, {"refine", "ADD"}, {"children", children}};
  for (std::size_t r = 0; r < 3; ++r) root["boundingVolume"]["box"][r] = scene.tiles.at(0).transform.m[r][3];
  const Json tileset = {{"asset", {{"version", "1.0"}, {"gltfUpAxis", "Z"}}}, {"geometricError", 1}, {"root", root}};
  publish_file(folder / "tileset.json", tileset.dump(), Durability::while_up);
  return folder / "tileset.json";
}

}  // namespace gigabake::bench
