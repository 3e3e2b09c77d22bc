#include "format/source/gltf/read.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "format/source/gltf/accessor.h"
#include "format/source/gltf/load.h"
#include "format/source/gltf/material.h"
#include "format/source/gltf/nodes.h"
#include "lattice/counted.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "lattice/transform.h"

namespace gigabake {
namespace {

/// Position, texture coordinates and colour as they are read and as they are kept; indices likewise.
constexpr std::uint64_t vertex_bytes = 12 + 8 + 16 + 8, corner_bytes = 8;

struct PrimitiveCounts {
  std::uint64_t triangles = 0, points = 0, lines = 0;
};

/// A glTF mesh's primitives in TileMesh::primitives, and what they count for each placement.
struct MeshParts {
  std::vector<int> primitives;
  PrimitiveCounts counts;
};

std::vector<std::uint32_t> triangle_list(const std::vector<std::uint32_t>& order, int mode) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return order;
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 2 < order.size(); ++i) {
    const bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
    const std::size_t odd = fan ? 0 : i % 2;
    out.push_back(order[i + (fan ? 1 : 0)]);
    out.push_back(fan ? order[i + 2] : order[i + 1 + odd]);
    out.push_back(fan ? order[0] : order[i + 2 - odd]);
  }
  return out;
}

std::uint64_t line_count(std::size_t vertices, int mode) {
  if (mode == TINYGLTF_MODE_LINE) return vertices / 2;
  return mode == TINYGLTF_MODE_LINE_LOOP ? vertices : (vertices > 0 ? vertices - 1 : 0);
}

std::uint16_t unit16(float v) { return v > 0 ? std::uint16_t(std::min(v, 1.0f) * 65535.0f + 0.5f) : std::uint16_t(0); }

class TileReader {
 public:
  TileReader(const TileRef& tile, const std::filesystem::path& root, ReadScope scope)
      : tile_(tile),
        everything_(scope == ReadScope::everything),
        document_(load_gltf(tile, root, everything_)),
        model_(document_.model) {
    const auto& rtc = document_.rtc_center;
    scene_from_tile_ = tile.scene_from_tile * translation<World, World>(rtc[0], rtc[1], rtc[2]);
  }

  TileMesh read() {
    read_materials();
    for_each_placement(tile_.path, model_, [this](const MeshPlacement& placement) { place(placement); });
    keep_images();
    return std::move(out_);
  }

 private:
  std::string where(int mesh, std::size_t primitive) const {
    return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
  }

  void read_materials() {
    for (std::size_t i = 0; i < model_.materials.size(); ++i)
      materials_.push_back(source_material(tile_.path, model_, int(i)));
    materials_.resize(model_.materials.size() + 1);  // the last is for primitives that name none
    for (const SourceMaterial& m : materials_) out_.materials.push_back(m.material);
  }

  void place(const MeshPlacement& placement) {
    auto found = meshes_.find(placement.mesh);
    if (found == meshes_.end()) found = meshes_.emplace(placement.mesh, read_mesh(placement.mesh)).first;
    const MeshParts& parts = found->second;
    const std::uint64_t times = document_.instances.size();
    out_.counts.triangles += times * parts.counts.triangles;
    out_.counts.skipped_points += times * parts.counts.points;
    out_.counts.skipped_lines += times * parts.counts.lines;
    if (document_.instances.size() * parts.primitives.size() > most_placements - out_.instances.size())
      throw InputError(tile_.path, "", "more than 2^24 placements of meshes; split the tile");
    claim_.add_items(times * parts.primitives.size(), placement_bytes, "nodes", "placements of meshes");
    const Affine<World, Local> model = z_up_from<World, Gltf>(tile_.gltf_up) * placement.gltf_from_local;
    for (const Affine<World, World>& instance : document_.instances) {
      const Affine<Scene, Local> scene_from_local = scene_from_tile_ * instance * model;
      if (!scene_from_local.is_finite()) throw InputError(tile_.path, "", "a placement in the scene is not finite");
      for (const int primitive : parts.primitives) out_.instances.push_back({primitive, scene_from_local});
    }
  }

  MeshParts read_mesh(int mesh) {
    MeshParts parts;
    const auto& primitives = model_.meshes[std::size_t(mesh)].primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives[i], where(mesh, i), parts);
    return parts;
  }

  void read_primitive(const tinygltf::Primitive& p, const std::string& at, MeshParts& parts) {
    const auto position = p.attributes.find("POSITION");
    if (position == p.attributes.end()) return;  // the specification lets it draw nothing
    if (component_count(model_, position->second) != 3)
      throw InputError(tile_.path, at + ".attributes.POSITION", "expected VEC3");
    const int mode = p.mode < 0 ? TINYGLTF_MODE_TRIANGLES : p.mode;
    const std::size_t vertices = model_.accessors[std::size_t(position->second)].count;
    claim_.add_items(vertices, vertex_bytes, at, "vertices");
    if (p.indices >= 0)
      claim_.add_items(model_.accessors[std::size_t(p.indices)].count, corner_bytes, at, "corners of triangles");
    const std::vector<std::uint32_t> order = vertex_order(p, at, vertices);
    if (mode == TINYGLTF_MODE_POINTS) parts.counts.points += order.size();
    if (mode >= TINYGLTF_MODE_LINE && mode <= TINYGLTF_MODE_LINE_STRIP)
      parts.counts.lines += line_count(order.size(), mode);
    if (mode < TINYGLTF_MODE_TRIANGLES) return;
    if (mode != TINYGLTF_MODE_TRIANGLES) claim_.add_items(order.size(), 3 * corner_bytes, at, "corners of a strip");
    if (mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)
      throw InputError(tile_.path, at,
                       counted(order.size(), "vertex is", "vertices are") + " no whole number of triangles");
    Primitive out;
    out.position = read_floats(model_, position->second, 3);
    out.position_step = quantization_step(model_, position->second);
    out.index = triangle_list(order, mode);
    out.material = p.material >= 0 ? p.material : int(model_.materials.size());
    read_appearance(p, at, vertices, out);
    parts.counts.triangles += out.index.size() / 3;
    parts.primitives.push_back(int(out_.primitives.size()));
    out_.primitives.push_back(std::move(out));
  }

  std::vector<std::uint32_t> vertex_order(const tinygltf::Primitive& p, const std::string& at,
                                          std::size_t vertices) const {
    std::vector<std::uint32_t> order;
    if (p.indices < 0) {
      order.resize(vertices);
      for (std::size_t i = 0; i < vertices; ++i) order[i] = std::uint32_t(i);
      return order;
    }
    order = read_indices(model_, p.indices);
    if (order.empty()) throw InputError(tile_.path, at + ".indices", "expected unsigned integers");
    for (std::size_t i = 0; i < order.size(); ++i)
      if (order[i] >= vertices)
        throw InputError(tile_.path, at + ".indices",
                         "index " + std::to_string(i) + " is " + std::to_string(order[i]) + ", beyond the " +
                             counted(vertices, "vertex", "vertices"));
    return order;
  }

  void read_appearance(const tinygltf::Primitive& p, const std::string& at, std::size_t vertices, Primitive& out) {
    const SourceMaterial& m = materials_[std::size_t(out.material)];
    const auto colour = p.attributes.find("COLOR_0");
    if (colour != p.attributes.end()) {
      expect_count(colour->second, vertices, at + ".attributes.COLOR_0");
      if (everything_) read_colours(colour->second, out);
    }
    const std::string set = "TEXCOORD_" + std::to_string(m.texcoord_set);
    const auto uv = p.attributes.find(set);
    if (m.material.texture.image < 0 || uv == p.attributes.end()) return;
    expect_count(uv->second, vertices, at + ".attributes." + set);
    if (!everything_) return;
    out.uv = read_floats(model_, uv->second, 2);
    const auto& t = m.uv_transform;
    for (std::size_t i = 0; i < out.uv.size(); i += 2) {
      const float u = out.uv[i], v = out.uv[i + 1];
      out.uv[i] = t[0][0] * u + t[0][1] * v + t[0][2];
      out.uv[i + 1] = t[1][0] * u + t[1][1] * v + t[1][2];
    }
  }

  void read_colours(int accessor, Primitive& out) const {
    const std::vector<float> rgba = read_floats(model_, accessor, 4, 1.0f);
    out.rgba.resize(rgba.size());
    std::transform(rgba.begin(), rgba.end(), out.rgba.begin(), unit16);
  }

  void expect_count(int accessor, std::size_t vertices, const std::string& at) const {
    const std::size_t items = model_.accessors[std::size_t(accessor)].count;
    if (items != vertices)
      throw InputError(tile_.path, at, counted(items, "item") + " for " + counted(vertices, "vertex", "vertices"));
  }

  /// What is missing is known from the survey on, not from the first cell that wants it.
  void keep_images() {
    for (std::size_t i = 0; i < document_.images.size(); ++i) {
      const std::string key = "images[" + std::to_string(i) + "]";
      const bool used = std::any_of(out_.primitives.begin(), out_.primitives.end(), [&](const Primitive& p) {
        return out_.materials[std::size_t(p.material)].texture.image == int(i);
      });
      if (used && !document_.has_image[i]) throw InputError(tile_.path, key, "the image is missing or empty");
      if (!everything_) continue;
      out_.images.push_back(
          {tile_.path.string() + ": " + key, used ? std::move(document_.images[i]) : std::vector<std::uint8_t>()});
    }
  }

  const TileRef& tile_;
  bool everything_;
  MemoryClaim claim_{tile_.path};
  GltfDocument document_;
  const tinygltf::Model& model_;
  Affine<Scene, World> scene_from_tile_;  ///< RTC_CENTER included
  std::vector<SourceMaterial> materials_;
  std::map<int, MeshParts> meshes_;
  TileMesh out_;
};

}  // namespace

TileMesh read_gltf(const TileRef& tile, const std::filesystem::path& root, ReadScope scope) {
  return TileReader(tile, root, scope).read();
}

}  // namespace gigabake
