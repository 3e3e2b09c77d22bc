#include "glb_scene.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <png.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace gigabake {
namespace {

template <class T>
void add_view(const std::vector<T>& values, std::string& bin, std::string& views) {
  while (bin.size() % 4 != 0) bin += '\0';
  const std::size_t size = values.size() * sizeof(T);
  views += (views.empty() ? "" : ",") + std::string("{\"buffer\":0,\"byteOffset\":") + std::to_string(bin.size()) +
           ",\"byteLength\":" + std::to_string(size) + "}";
  bin.append(reinterpret_cast<const char*>(values.data()), size);
}

std::string accessor(int view, int component, std::size_t count, const char* type) {
  return "{\"bufferView\":" + std::to_string(view) + ",\"componentType\":" + std::to_string(component) +
         ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"";
}

std::string text(float x) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.9g", double(x));
  return buffer;
}

std::string position_bounds(const std::vector<float>& p) {
  std::string low, high;
  for (std::size_t c = 0; c < 3; ++c) {
    float lo = p[c], hi = p[c];
    for (std::size_t i = c; i < p.size(); i += 3) lo = std::min(lo, p[i]), hi = std::max(hi, p[i]);
    low += (c ? "," : "") + text(lo);
    high += (c ? "," : "") + text(hi);
  }
  return ",\"min\":[" + low + "],\"max\":[" + high + "]}";
}

std::string material_json(const GlbMesh& mesh) {
  if (mesh.image.empty()) return mesh.material;
  const std::string texture = "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}";
  const std::string head = mesh.material.substr(0, mesh.material.size() - 1);
  return head + (head == "{" ? "" : ",") + texture + "}";
}

void append_chunk(std::string& out, const std::string& type, std::string data, char pad) {
  while (data.size() % 4 != 0) data += pad;
  const std::uint32_t size = std::uint32_t(data.size());
  out.append(reinterpret_cast<const char*>(&size), 4).append(type).append(data);
}

}  // namespace

ScratchFolder::ScratchFolder() {
  static std::atomic<int> number{0};
  path_ = std::filesystem::temp_directory_path() /
          ("gigabake_test_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
  std::filesystem::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

GlbMesh rolling_ground(int n, double east_m, double north_m) {
  GlbMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double e = east_m + i, s = -(north_m + j);
      mesh.position.insert(mesh.position.end(), {float(e), float(3 * std::sin(e * 0.3) * std::cos(s * 0.2)), float(s)});
      mesh.uv.insert(mesh.uv.end(), {float(i) / float(n), float(j) / float(n)});
    }
  const auto vertex = [n](int i, int j) { return std::uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      mesh.index.insert(mesh.index.end(), {vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j),
                                           vertex(i + 1, j + 1), vertex(i, j + 1)});
  return mesh;
}

std::vector<std::uint8_t> checkered_png(int n) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      rgba.insert(rgba.end(),
                  {std::uint8_t(255 * x / n), std::uint8_t(255 * y / n), std::uint8_t((x ^ y) & 1 ? 255 : 0), 255});
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = png_uint_32(n);
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, rgba.data(), 0, nullptr);
  std::vector<std::uint8_t> out(size);
  png_image_write_to_memory(&image, out.data(), &size, 0, rgba.data(), 0, nullptr);
  out.resize(size);
  return out;
}

void write_glb(const std::filesystem::path& path, const GlbMesh& mesh) {
  std::string bin, views;
  add_view(mesh.position, bin, views);
  add_view(mesh.index, bin, views);
  std::string accessors = accessor(0, 5126, mesh.position.size() / 3, "VEC3") + position_bounds(mesh.position) + "," +
                          accessor(1, 5125, mesh.index.size(), "SCALAR") + "}";
  std::string attributes = "\"POSITION\":0", textures;
  if (!mesh.uv.empty()) {
    add_view(mesh.uv, bin, views);
    accessors += "," + accessor(2, 5126, mesh.uv.size() / 2, "VEC2") + "}";
    attributes += ",\"TEXCOORD_0\":2";
  }
  if (!mesh.normal.empty()) {
    add_view(mesh.normal, bin, views);
    accessors += "," + accessor(3, 5126, mesh.normal.size() / 3, "VEC3") + "}";
    attributes += ",\"NORMAL\":3";
  }
  if (!mesh.image.empty()) {
    add_view(mesh.image, bin, views);
    textures = std::string("\"images\":[{\"mimeType\":\"image/png\",\"bufferView\":") +
               (mesh.uv.empty()       ? "2"
                : mesh.normal.empty() ? "3"
                                      : "4") +
               "}],\"textures\":[{\"source\":0}],";
  }
  const std::string json =
      "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{"
      "\"primitives\":"
      "[{\"attributes\":{" +
      attributes + "},\"indices\":1,\"material\":0,\"extensions\":" + mesh.extensions + "}]}]," + textures +
      "\"materials\":[" + material_json(mesh) + "],\"accessors\":[" + accessors + "],\"bufferViews\":[" + views +
      "],\"buffers\":[{\"byteLength\":" + std::to_string(bin.size()) + "}]}";
  std::string chunks;
  append_chunk(chunks, "JSON", json, ' ');
  append_chunk(chunks, std::string("BIN\0", 4), bin, '\0');
  const std::uint32_t header[3] = {0x46546c67, 2, std::uint32_t(12 + chunks.size())};
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(header), 12);
  out << chunks;
}

SceneSources sources_of(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  SceneSources sources;
  sources.root = folder;
  for (const std::string& name : files) {
    TileRef tile;
    tile.path = folder / name;
    tile.name = name;
    std::error_code missing;
    tile.bytes = std::filesystem::file_size(tile.path, missing);
    sources.tiles.push_back(tile);
  }
  return sources;
}

std::vector<CellReport> bake_all(CellPipeline& pipeline, const std::vector<CellJob>& jobs) {
  for (const CellJob& job : jobs) pipeline.submit(job);
  std::vector<CellReport> reports;
  while (pipeline.in_flight() != 0) {
    if (auto report = pipeline.poll())
      reports.push_back(std::move(*report));
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::ranges::sort(reports, {}, &CellReport::id);
  return reports;
}

}  // namespace gigabake
