/// A GLB for a test. add() writes a list into the binary chunk, and the test may change the JSON document.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "source_scene.h"

namespace gigabake::test {

class MadeGlb {
 public:
  /// Adds an accessor of the values, with `width` values per item, and returns its index. If `stride` is not 0, items
  /// are `stride` bytes apart, with random bytes in between.
  template <class T>
  int add(const std::vector<T>& values, int width, int component, bool normalized = false, std::size_t stride = 0) {
    const std::size_t item = sizeof(T) * std::size_t(width), items = values.size() / std::size_t(width);
    const int view = add_view(items, stride == 0 ? item : stride, stride, [&](std::size_t i, std::uint8_t* to) {
      std::memcpy(to, &values[i * std::size_t(width)], item);
    });
    const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    Json accessor{{"bufferView", view}, {"componentType", component}, {"count", items}, {"type", types[width]}};
    if (normalized) accessor["normalized"] = true;
    gltf["accessors"].push_back(accessor);
    return int(gltf["accessors"].size()) - 1;
  }

  /// Adds a primitive to the only mesh, and returns it.
  Json& add_primitive(int position, int indices = -1, int mode = 4) {
    Json p{{"attributes", {{"POSITION", position}}}, {"mode", mode}};
    if (indices >= 0) p["indices"] = indices;
    gltf["meshes"][0]["primitives"].push_back(p);
    return gltf["meshes"][0]["primitives"].back();
  }

  /// Returns the bytes of the file.
  std::string glb() const {
    Json whole = gltf;
    whole["buffers"] = Json::array({{{"byteLength", bin.size()}}});
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out;
    const auto words = [&](std::initializer_list<std::size_t> values) {
      for (const std::size_t v : values)
        for (unsigned shift = 0; shift < 32; shift += 8) out += char(v >> shift);
    };
    words({0x46546c67, 2, 12 + 8 + text.size() + 8 + bin.size(), text.size(), 0x4e4f534a});
    out += text;
    words({bin.size(), 0x004e4942});
    out.append(bin.begin(), bin.end());
    return out;
  }

  /// Returns the document with the file `uri` as its only buffer. The file should contain `bin`.
  Json gltf_of(const std::string& uri) const {
    Json whole = gltf;
    whole["buffers"] = Json::array({{{"byteLength", bin.size()}, {"uri", uri}}});
    return whole;
  }

  Json gltf{{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},      {"meshes", {{{"primitives", Json::array()}}}},
            {"accessors", Json::array()},    {"bufferViews", Json::array()}};
  std::vector<std::uint8_t> bin;

 private:
  template <class Write>
  int add_view(std::size_t items, std::size_t step, std::size_t stride, const Write& write) {
    const std::size_t begin = bin.size();
    bin.resize((begin + items * step + 3) / 4 * 4, 0xab);
    for (std::size_t i = 0; i < items; ++i) write(i, bin.data() + begin + i * step);
    Json view{{"buffer", 0}, {"byteOffset", begin}, {"byteLength", items * step}};
    if (stride != 0) view["byteStride"] = stride;
    gltf["bufferViews"].push_back(view);
    return int(gltf["bufferViews"].size()) - 1;
  }
};

inline constexpr int of_bytes = 5121, of_shorts = 5123, of_signed_shorts = 5122, of_words = 5125, of_floats = 5126;

}  // namespace gigabake::test
