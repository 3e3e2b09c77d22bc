#include "source_scene.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

namespace gigabake::test {
namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, std::initializer_list<T> values) {
  for (const T v : values) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(&bytes[at], &v, sizeof(T));
  }
}

}  // namespace

SourceFolder::SourceFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "gigabake-source-XXXXXX").string();
  path_ = std::filesystem::canonical(mkdtemp(name.data()));
}

SourceFolder::~SourceFolder() { std::filesystem::remove_all(path_); }

std::filesystem::path SourceFolder::write(const std::string& name, const std::string& content) const {
  const std::filesystem::path file = path_ / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

Json square_gltf() {
  std::vector<std::uint8_t> bytes;
  append<float>(bytes, {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1});
  append<std::uint16_t>(bytes, {0, 2, 1, 0, 3, 2});
  Json g;
  g["asset"]["version"] = "2.0";
  g["scene"] = 0;
  g["scenes"] = Json::array({{{"nodes", {0}}}});
  g["nodes"] = Json::array({{{"mesh", 0}}});
  g["meshes"] = Json::array({{{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}})}}});
  g["accessors"] = Json::array({{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                                {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}});
  g["bufferViews"] = Json::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
                                  {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}}});
  g["buffers"] =
      Json::array({{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}});
  return g;
}

Json tile(const std::string& uri, const Json& children) {
  Json t{{"geometricError", 1}, {"boundingVolume", {{"sphere", {0, 0, 0, 10}}}}};
  if (!uri.empty()) t["content"] = {{"uri", uri}};
  if (!children.empty()) t["children"] = children;
  return t;
}

Json tileset(const Json& root) { return {{"asset", {{"version", "1.1"}}}, {"geometricError", 1}, {"root", root}}; }

}  // namespace gigabake::test
