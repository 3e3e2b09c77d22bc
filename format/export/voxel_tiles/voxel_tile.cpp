#include "format/export/voxel_tiles/voxel_tile.h"

#include <nlohmann/json.hpp>
#include <string>

namespace gigabake {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t voxel_mode = 0x7fffffff;  ///< glTF mode of primitives whose geometry is defined by an extension
constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

void put_number(std::vector<std::uint8_t>& to, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) to.push_back(std::uint8_t(value >> shift));
}

std::span<const std::uint8_t> class_bytes_of(const VoxelGrid& grid) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(grid.classes().data());
  return {first, sizeof(float) * grid.classes().size()};
}

Json three(std::uint32_t value) { return {value, value, value}; }

/// Adds accessors and buffer views of the attributes: colours, normals, then classes if the grid has them.
void add_columns(Json& document, const VoxelGrid& grid) {
  const std::size_t voxels = grid.size(), class_bytes = sizeof(float) * grid.classes().size();
  document["accessors"] = Json::array();
  document["bufferViews"] = Json::array();
  for (std::size_t view = 0; view < 2; ++view) {
    document["accessors"].push_back({{"bufferView", view},
                                     {"byteOffset", 0},
                                     {"componentType", 5121},
                                     {"normalized", true},
                                     {"count", voxels},
                                     {"type", "VEC4"}});
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 4 * voxels * view}, {"byteLength", 4 * voxels}});
  }
  document["buffers"] = Json::array({{{"byteLength", 8 * voxels + class_bytes}}});
  if (class_bytes == 0) return;
  document["accessors"].push_back(
      {{"bufferView", 2}, {"byteOffset", 0}, {"componentType", 5126}, {"count", voxels}, {"type", "SCALAR"}});
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 8 * voxels}, {"byteLength", class_bytes}});
}

/// The names of a tile's attributes.
struct AttributeNames {
  const char *color, *normal, *voxel_class;
};

Json attributes_of(const VoxelGrid& grid, const AttributeNames& names) {
  Json attributes = {{names.color, 0}, {names.normal, 1}};
  if (!grid.classes().empty()) attributes[names.voxel_class] = 2;
  return attributes;
}

Json shape_of(const TileBox& box) {
  return {{"type", "box"}, {"box", {{"size", {box.edge_m, box.edge_m, box.edge_m}}}}};
}

Json metadata_of(const VoxelGrid& grid, const AttributeNames& names) {
  Json mapped = {{"color", {{"attribute", names.color}}}, {"normal", {{"attribute", names.normal}}}};
  if (!grid.classes().empty()) mapped["voxel_class"] = {{"attribute", names.voxel_class}};
  return {{"schema", voxel_schema(!grid.classes().empty())},
          {"propertyAttributes", Json::array({{{"class", "voxel"}, {"properties", mapped}}})}};
}

Json document_of(const VoxelGrid& grid, const TileBox& box) {
  constexpr AttributeNames names{"_color", "_normal", "_class"};
  const Json shape = shape_of(box), metadata = metadata_of(grid, names);
  const Json grid_of = {
      {"shape", 0}, {"dimensions", three(grid.edge() - 2)}, {"padding", {{"before", three(1)}, {"after", three(1)}}}};
  const Json primitive = {
      {"attributes", attributes_of(grid, names)},
      {"mode", voxel_mode},
      {"extensions", {{"EXT_primitive_voxels", grid_of}, {"EXT_structural_metadata", {{"propertyAttributes", {0}}}}}}};
  const std::vector<std::string> extensions{"EXT_primitive_voxels", "EXT_structural_metadata", "KHR_implicit_shapes"};
  Json document = {
      {"asset", {{"version", "2.0"}}},
      {"extensionsUsed", extensions},
      {"extensionsRequired", extensions},
      {"extensions",
       {{"KHR_implicit_shapes", {{"shapes", Json::array({shape})}}}, {"EXT_structural_metadata", metadata}}},
      {"scene", 0},
      {"scenes", Json::array({{{"nodes", {0}}}})},
      {"nodes", Json::array({{{"mesh", 0}, {"translation", {box.centre_m[0], box.centre_m[2], -box.centre_m[1]}}}})},
      {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})}};
  add_columns(document, grid);
  return document;
}

Json node_document_of(const VoxelGrid& grid, const TileBox& box) {
  constexpr AttributeNames names{"_COLOR", "_NORMAL", "_CLASS"};
  const Json voxels = {{"dimensions", three(grid.edge() - 2)},
                       {"padding", {{"before", three(1)}, {"after", three(1)}}},
                       {"attributes", attributes_of(grid, names)},
                       {"extensions", {{"EXT_structural_metadata", {{"propertyAttributes", {0}}}}}}};
  const std::vector<std::string> extensions{"EXT_voxels", "EXT_structural_metadata"};
  const Json node = {{"translation", in_gltf_2_1(box.centre_m)},
                     {"boundingVolume", {{"shape", 0}}},
                     {"extensions", {{"EXT_voxels", voxels}}}};
  Json document = {{"asset", {{"version", "2.1"}}},
                   {"extensionsUsed", extensions},
                   {"extensionsRequired", extensions},
                   {"shapes", Json::array({shape_of(box)})},
                   {"extensions", {{"EXT_structural_metadata", metadata_of(grid, names)}}},
                   {"scene", 0},
                   {"scenes", Json::array({{{"nodes", {0}}}})},
                   {"nodes", Json::array({node})}};
  add_columns(document, grid);
  return document;
}

}  // namespace

Json voxel_schema(bool has_classes) {
  const double zero = -128.0 / 127, step = 255.0 / 127;
  Json properties = {
      {"color",
       {{"description", "sRGB colour and coverage; zeros where there is no voxel"},
        {"type", "VEC4"},
        {"componentType", "UINT8"},
        {"normalized", true}}},
      {"normal",
       {{"description", "x, y, z of the surface's normal (0 where it is unknown), and 1 where there is a voxel"},
        {"type", "VEC4"},
        {"componentType", "UINT8"},
        {"normalized", true},
        {"offset", {zero, zero, zero, 0}},
        {"scale", {step, step, step, 1}}}}};
  if (has_classes)
    properties["voxel_class"] = {{"description", "class of the voxel; 0 where it has none or there is no voxel"},
                                 {"type", "SCALAR"},
                                 {"componentType", "FLOAT32"}};
  return {{"id", "gigabake"}, {"classes", {{"voxel", {{"properties", properties}}}}}};
}

Vec3d in_gltf_2_1(const Vec3d& p) { return {-p[0], p[2], p[1]}; }

void make_glb(const Json& document, std::initializer_list<std::span<const std::uint8_t>> parts_of_buffer,
              std::vector<std::uint8_t>& file) {
  std::string json = document.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::size_t bytes = 0;
  for (const std::span<const std::uint8_t> part : parts_of_buffer) bytes += part.size();
  const std::size_t padding = (4 - bytes % 4) % 4;
  file.clear();
  file.reserve(28 + json.size() + bytes + padding);
  for (const std::size_t number : {std::size_t(glb_magic), std::size_t(2), 28 + json.size() + bytes + padding,
                                   json.size(), std::size_t(json_chunk)})
    put_number(file, std::uint32_t(number));
  file.insert(file.end(), json.begin(), json.end());
  put_number(file, std::uint32_t(bytes + padding));
  put_number(file, binary_chunk);
  for (const std::span<const std::uint8_t> part : parts_of_buffer) file.insert(file.end(), part.begin(), part.end());
  file.resize(file.size() + padding);
}

void make_voxel_tile(const VoxelGrid& grid, const TileBox& box, std::vector<std::uint8_t>& file) {
  make_glb(document_of(grid, box), {grid.rgba(), grid.normals(), class_bytes_of(grid)}, file);
}

void make_voxel_node(const VoxelGrid& grid, const TileBox& box, std::vector<std::uint8_t>& file) {
  make_glb(node_document_of(grid, box), {grid.rgba(), grid.normals(), class_bytes_of(grid)}, file);
}

}  // namespace gigabake
