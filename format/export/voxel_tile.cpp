#include "format/export/voxel_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "format/system/output_file.h"
#include "lattice/error.h"
#include "lattice/octahedral.h"
#include "lattice/srgb.h"

namespace gigabake {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t voxel_mode = 0x7fffffff;  ///< glTF primitives whose geometry an extension says
constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

/// glTF has y up: x stays, y is the tileset's z, z is its −y; x is contiguous, then y, then z.
std::size_t place_in_gltf(std::size_t voxel) {
  const std::size_t x = voxel & 7, y = voxel >> 3 & 7, z = voxel >> 6;
  return x + 8 * (z + 8 * (7 - y));
}

/// Mean over the three axes of what a view along the axis sees.
std::uint32_t covered(const std::array<std::uint32_t, 8>& alpha) {
  std::uint32_t sum = 0;
  for (std::uint32_t axis = 1; axis < 8; axis *= 2)
    for (std::uint32_t c = 0; c < 8; ++c)
      if ((c & axis) == 0) sum += 255 * (alpha[c] + alpha[c | axis]) - alpha[c] * alpha[c | axis];
  return std::max(1u, (sum + 1530) / 3060);
}

/// Eight voxels that make one.
struct Octet {
  std::array<std::uint32_t, 8> alpha{};
  std::uint32_t weight = 0;
  std::array<double, 3> colour{}, normal{};

  void add(std::size_t c, const std::array<std::uint8_t, 4>& rgba, const std::array<float, 3>& n) {
    const std::array<double, 256>& linear = linear_of_srgb();
    alpha[c] = rgba[3];
    weight += rgba[3];
    for (std::size_t i = 0; i < 3; ++i) {
      colour[i] += rgba[3] * linear[rgba[i]];
      normal[i] += rgba[3] * double(n[i]);
    }
  }

  void store(std::array<std::uint8_t, 4>& rgba, std::array<float, 3>& n) const {
    const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      rgba[i] = srgb_byte(colour[i] / weight);
      n[i] = length > 0 ? float(normal[i] / length) : 0.0f;
    }
    rgba[3] = std::uint8_t(covered(alpha));
  }
};

Json attribute(std::size_t view) { return {{"bufferView", view}, {"byteOffset", 0}, {"count", brick_voxels}}; }

/// The document of a tile. `bytes` of voxels: normals first, so that they are aligned.
Json document(const TileBox& box, bool normals, std::size_t bytes) {
  Json attributes, properties, mapped, views, accessors;
  const auto add = [&](const char* name, const Json& property, const Json& accessor, std::size_t size) {
    const std::string attribute_name = std::string("_") + name;
    attributes[attribute_name] = accessors.size();
    mapped[name] = {{"attribute", attribute_name}};
    properties[name] = property;
    accessors.push_back(attribute(views.size()));
    accessors.back().update(accessor);
    views.push_back({{"buffer", 0}, {"byteOffset", bytes - size}, {"byteLength", size}});
  };
  views = Json::array();
  accessors = Json::array();
  if (normals) {
    add("normal", {{"type", "VEC3"}, {"componentType", "FLOAT32"}}, {{"componentType", 5126}, {"type", "VEC3"}},
        12 * brick_voxels);
    views.back()["byteOffset"] = 0;
  }
  add("color", {{"type", "VEC4"}, {"componentType", "UINT8"}, {"normalized", true}},
      {{"componentType", 5121}, {"normalized", true}, {"type", "VEC4"}}, 4 * brick_voxels);
  const Json shape = {{"type", "box"}, {"box", {{"size", {box.edge_m, box.edge_m, box.edge_m}}}}};
  const Json metadata = {{"schema", {{"id", "voxel"}, {"classes", {{"voxel", {{"properties", properties}}}}}}},
                         {"propertyAttributes", Json::array({{{"class", "voxel"}, {"properties", mapped}}})}};
  const Json primitive = {{"attributes", attributes},
                          {"mode", voxel_mode},
                          {"extensions",
                           {{"EXT_primitive_voxels", {{"shape", 0}, {"dimensions", {8, 8, 8}}}},
                            {"EXT_structural_metadata", {{"propertyAttributes", {0}}}}}}};
  const std::vector<std::string> extensions{"EXT_primitive_voxels", "EXT_structural_metadata", "KHR_implicit_shapes"};
  return {
      {"asset", {{"version", "2.0"}}},
      {"extensionsUsed", extensions},
      {"extensionsRequired", extensions},
      {"extensions",
       {{"KHR_implicit_shapes", {{"shapes", Json::array({shape})}}}, {"EXT_structural_metadata", metadata}}},
      {"scene", 0},
      {"scenes", Json::array({{{"nodes", {0}}}})},
      {"nodes", Json::array({{{"mesh", 0}, {"translation", {box.centre_m[0], box.centre_m[2], -box.centre_m[1]}}}})},
      {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})},
      {"accessors", accessors},
      {"bufferViews", views},
      {"buffers", Json::array({{{"byteLength", bytes}}})}};
}

}  // namespace

void add_voxels(VoxelTile& tile, const DenseBrick& part, bool normals) {
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    if (!part.has(voxel)) continue;
    tile.rgba[voxel] = part.rgba[voxel];
    if (normals) tile.normal[voxel] = unit_normal(part.normal[voxel].data());
  }
}

VoxelTile coarser_tile(const std::array<const VoxelTile*, 8>& children) {
  VoxelTile tile;
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    const std::array<std::size_t, 3> at{voxel & 7, voxel >> 3 & 7, voxel >> 6};
    const VoxelTile* child = children[at[0] >> 2 | at[1] >> 2 << 1 | at[2] >> 2 << 2];
    if (child == nullptr) continue;
    Octet octet;
    for (std::size_t c = 0; c < 8; ++c) {
      const std::size_t from =
          (2 * at[0] + (c & 1)) % 8 + 8 * ((2 * at[1] + (c >> 1 & 1)) % 8) + 64 * ((2 * at[2] + (c >> 2)) % 8);
      octet.add(c, child->rgba[from], child->normal[from]);
    }
    if (octet.weight > 0) octet.store(tile.rgba[voxel], tile.normal[voxel]);
  }
  return tile;
}

VoxelTileFiles::VoxelTileFiles(std::filesystem::path target, std::filesystem::path folder, bool normals)
    : target_(std::move(target)), folder_(std::move(folder)), normals_(normals) {}

void VoxelTileFiles::write(const std::filesystem::path& name, const VoxelTile& tile, const TileBox& box) const {
  std::string json = document(box, normals_, voxel_bytes()).dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  auto normal = VoxelTile().normal;
  auto rgba = VoxelTile().rgba;
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    normal[place_in_gltf(voxel)] = tile.normal[voxel];
    rgba[place_in_gltf(voxel)] = tile.rgba[voxel];
  }
  OutputFile out(target_, folder_ / name);
  out.put(glb_magic);
  out.put(std::uint32_t(2));
  out.put(std::uint32_t(12 + 8 + json.size() + 8 + voxel_bytes()));
  out.put(std::uint32_t(json.size()));
  out.put(json_chunk);
  out.write(json);
  out.put(std::uint32_t(voxel_bytes()));
  out.put(binary_chunk);
  if (normals_) out.put(normal);
  out.put(rgba);
  out.finish();
}

bool VoxelTileFiles::read(const std::filesystem::path& name, VoxelTile& tile) const {
  std::ifstream file(folder_ / name, std::ios::binary);
  if (!file) return false;
  std::array<char, std::size_t(brick_voxels) * 16> bytes{};
  file.seekg(-std::streamoff(voxel_bytes()), std::ios::end);
  if (!file.read(bytes.data(), std::streamsize(voxel_bytes())))
    throw InputError(target_, name.string(), "cannot be read back");
  const char* const rgba = bytes.data() + (normals_ ? 12 * brick_voxels : 0);
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    const std::size_t i = place_in_gltf(voxel);
    if (normals_) std::memcpy(tile.normal[voxel].data(), bytes.data() + 12 * i, 12);
    std::memcpy(tile.rgba[voxel].data(), rgba + 4 * i, 4);
  }
  return true;
}

}  // namespace gigabake
