#include "format/source/gltf/read.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "core/math/transform.h"
#include "format/source/classes/instance_ids.h"
#include "format/source/gltf/accessor.h"
#include "format/source/gltf/corners.h"
#include "format/source/gltf/load.h"
#include "format/source/gltf/material.h"
#include "format/source/gltf/model/vertex_values.h"
#include "format/source/gltf/nodes.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/mesh_parts.h"

namespace gigabake {
namespace {

struct PrimitiveCounts {
  std::uint64_t triangles = 0, points = 0, lines = 0;
};

/// Primitives of a glTF mesh in TileMesh::primitives, and their counts per placement.
struct MeshParts {
  std::vector<int> primitives;
  PrimitiveCounts counts;
};

std::uint64_t part_count(std::uint64_t triangles) { return (triangles + max_part_triangles - 1) / max_part_triangles; }

std::uint64_t line_count(std::uint64_t vertices, int mode) {
  if (mode == TINYGLTF_MODE_LINE) return vertices / 2;
  return mode == TINYGLTF_MODE_LINE_LOOP ? vertices : (vertices > 0 ? vertices - 1 : 0);
}

/// Memory claim of a primitive, given back when the primitive has been passed on.
class HeldClaim {
 public:
  explicit HeldClaim(MemoryClaim& claim) : claim_(claim) {}
  HeldClaim(const HeldClaim&) = delete;
  ~HeldClaim() { claim_.give_back(bytes_); }
  void add_items(std::uint64_t items, std::uint64_t item_bytes, const std::string& key, const char* what) {
    claim_.add_items(items, item_bytes, key, what);
    bytes_ += items * item_bytes;
  }
  void keep() { bytes_ = 0; }

 private:
  MemoryClaim& claim_;
  std::uint64_t bytes_ = 0;
};

class TileReader {
 public:
  TileReader(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, const PrimitiveSink& sink,
             const ThreadPool& pool)
      : tile_(tile),
        sink_(sink),
        pool_(pool),
        everything_(scope != ReadScope::positions_only),
        with_normals_(scope == ReadScope::everything),
        document_(load_gltf(tile, root, everything_ || has_id_textures(tile))),
        model_(document_.model) {
    const auto& rtc = document_.rtc_center;
    scene_from_tile_ = tile.scene_from_tile * translation<World, World>(rtc[0], rtc[1], rtc[2]);
  }

  TileMesh read() {
    read_materials();
    count_unused_states(model_, warnings_);
    if (document_.has_unused_instance_ids) warnings_.count(unused_instance_ids, "BATCH_ID");
    if (!document_.instance_ids.empty())
      classes_of_i3dm_ = classes_of_i3dm(tile_.path, document_.instance_ids, *tile_.classes);
    for_each_placement(tile_, document_, warnings_, [this](const MeshPlacement& placement) { place(placement); });
    keep_images();
    out_.warnings = warnings_.take();
    return std::move(out_);
  }

 private:
  /// Returns whether textures of the tile may have ids. Their texels are checked in each scope.
  static bool has_id_textures(const TileRef& tile) {
    return tile.classes && tile.classes->ids && tile.classes->ids->feature_set;
  }

  std::string where(int mesh, std::size_t primitive) const {
    return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
  }

  void read_materials() {
    for (std::size_t i = 0; i < model_.materials.size(); ++i)
      materials_.push_back(source_material(tile_.path, model_, int(i), warnings_));
    materials_.resize(model_.materials.size() + 1);  // the last material is for primitives without a material
    for (SourceMaterial& m : materials_) {
      const int image = m.material.texture.image;
      if (image >= 0 && m.texture.fault.empty()) m.texture.fault = document_.image_faults[std::size_t(image)];
      if (!m.texture.fault.empty()) make_grey(m.material);
      TextureUse& map = m.material.normal_map.texture;
      if (map.image >= 0 && m.normal_map.fault.empty())
        m.normal_map.fault = document_.image_faults[std::size_t(map.image)];
      if (!m.normal_map.fault.empty()) map = {};
      out_.materials.push_back(m.material);
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < model_.materials.size(); ++i) {
      const std::string& name = model_.materials[i].name;
      out_.materials[i].voxel_class = class_of_material(tile_.classes.get(), name);
      names.insert(name);
    }
    out_.classified = classified_names(tile_.classes.get(), names);
    std::set<std::string> nodes;
    for (const tinygltf::Node& node : model_.nodes) nodes.insert(node.name);
    out_.sized = sized_names(tile_.named_sizes.get(), names, nodes);
  }

  /// Makes a material with an unusable image grey, so that the rest of the tile can be baked.
  static void make_grey(Material& m) {
    m.texture = {};
    for (std::size_t c = 0; c < 3; ++c) m.base_color[c] *= grey_without_image;
  }

  void place(const MeshPlacement& placement) {
    auto found = meshes_.find(placement.mesh);
    if (found == meshes_.end()) found = meshes_.emplace(placement.mesh, read_mesh(placement.mesh)).first;
    const MeshParts& parts = found->second;
    const std::uint64_t times = document_.instances.size();
    out_.counts.triangles += times * parts.counts.triangles;
    out_.counts.skipped_points += times * parts.counts.points;
    out_.counts.skipped_lines += times * parts.counts.lines;
    if (document_.instances.size() * parts.primitives.size() > max_placements - out_.instances.size())
      throw InputError(tile_.path, "", "more than 2^24 placements of meshes; split the tile");
    claim_.add_items(times * parts.primitives.size(), placement_bytes, "nodes", "placements of meshes");
    const Affine<World, Local> model = z_up_from<World, Gltf>(tile_.gltf_up) * placement.gltf_from_local;
    for (std::size_t i = 0; i < document_.instances.size(); ++i) {
      const Affine<Scene, Local> scene_from_local = scene_from_tile_ * document_.instances[i] * model;
      const std::int32_t voxel_class = classes_of_i3dm_.empty() ? placement.voxel_class : classes_of_i3dm_[i];
      if (!scene_from_local.is_finite()) throw InputError(tile_.path, "", "a placement in the scene is not finite");
      for (const int primitive : parts.primitives)
        out_.instances.push_back({primitive, scene_from_local, lod_of(primitive, placement), voxel_class});
    }
  }

  /// Returns the level of a placed primitive: that of its material, else that of its node.
  std::int32_t lod_of(int primitive, const MeshPlacement& placement) const {
    const std::size_t material = std::size_t(out_.primitives[std::size_t(primitive)].material);
    if (material >= model_.materials.size()) return placement.lod;
    const std::int32_t lod = lod_of_material(tile_.named_sizes.get(), model_.materials[material].name);
    return lod == not_stated ? placement.lod : lod;
  }

  MeshParts read_mesh(int mesh) {
    MeshParts parts;
    const auto& primitives = model_.meshes[std::size_t(mesh)].primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives[i], where(mesh, i), parts);
    return parts;
  }

  void read_primitive(const tinygltf::Primitive& p, const std::string& at, MeshParts& parts) {
    const auto position = p.attributes.find("POSITION");
    if (position == p.attributes.end()) return;  // a primitive without positions draws nothing, by the specification
    if (component_count(model_, position->second) != 3)
      throw InputError(tile_.path, at + ".attributes.POSITION", "expected VEC3");
    const std::uint64_t vertices = model_.accessors[std::size_t(position->second)].count;
    const Corners corners(tile_.path, document_, p, at, vertices);
    if (corners.mode() == TINYGLTF_MODE_POINTS) parts.counts.points += corners.drawn();
    if (corners.mode() >= TINYGLTF_MODE_LINE && corners.mode() <= TINYGLTF_MODE_LINE_STRIP)
      parts.counts.lines += line_count(corners.drawn(), corners.mode());
    if (corners.mode() < TINYGLTF_MODE_TRIANGLES) return corners.check();
    VertexValues values{AccessorItems(tile_.path, document_, position->second), material_of(p)};
    find_appearance(p, at, values);
    find_normals(p, at, values);
    find_normal_map(p, at, values);
    if (takes_primitive_ids(tile_.classes.get()))
      find_ids(p, at, values);
    else
      count_unused_ids(p, at, warnings_);
    parts.counts.triangles += corners.triangles();
    if (!sink_ || !is_split(corners.triangles(), vertices)) {
      add_whole(corners, values, at, parts);
    } else {
      add_parts(corners, values, at, parts);
    }
  }

  /// Returns the primitive's material; the last material is for primitives without one.
  int material_of(const tinygltf::Primitive& p) const {
    return p.material >= 0 ? p.material : int(model_.materials.size());
  }

  void find_appearance(const tinygltf::Primitive& p, const std::string& at, VertexValues& out) {
    const auto find = [&](const std::string& name, std::optional<AccessorItems>& items) {
      const auto attribute = p.attributes.find(name);
      if (attribute == p.attributes.end()) return;
      expect_count(attribute->second, out.position.count(), at + ".attributes." + name);
      if (everything_) items.emplace(tile_.path, document_, attribute->second);
    };
    const SourceMaterial& m = materials_[std::size_t(out.material)];
    find("COLOR_0", out.colour);
    if (m.material.texture.image < 0) return;
    const std::string set = set_name(m.texture);
    if (!p.attributes.contains(set))
      warnings_.count("primitives without the texture coordinates of their texture", at + "." + set);
    find(set, out.uv);
  }

  /// Finds the ids of a primitive. Checks each image of ids once.
  void find_ids(const tinygltf::Primitive& p, const std::string& at, VertexValues& out) {
    out.ids.emplace(tile_.path, document_, p, at, *tile_.classes, warnings_);
    const IdTextureSource* texture = out.ids->texture();
    if (texture != nullptr && checked_ids_.insert({texture->texture.image, texture->ids}).second)
      out.ids->check_texels(tile_.path, document_, warnings_);
  }

  /// Finds the normals of the vertices, and counts the normals without a direction. Without a sink and with it, the
  /// counts are the same.
  void find_normals(const tinygltf::Primitive& p, const std::string& at, VertexValues& out) {
    const auto attribute = p.attributes.find("NORMAL");
    if (attribute == p.attributes.end()) return;
    const std::string key = at + ".attributes.NORMAL";
    AccessorItems normals(tile_.path, document_, attribute->second);
    if (normals.components() != 3 || normals.count() != out.position.count())
      return warnings_.count("normals that do not fit the positions, ignored", key);
    for_each_block(normals, 3, [&](const std::vector<float>& xyz) {
      for (const VertexNormal& n : vertex_normals(xyz))
        if (n[0] == no_vertex_normal) warnings_.count(bad_vertex_normals, key);
    });
    if (with_normals_) out.normal.emplace(std::move(normals));
  }

  /// Calls visit(values) for consecutive blocks of items.
  template <class Visit>
  static void for_each_block(const AccessorItems& all, int components, const Visit& visit) {
    constexpr std::uint64_t block = 1 << 16;
    std::vector<std::uint32_t> items;
    for (std::uint64_t first = 0; first < all.count(); first += block) {
      items.resize(std::min(block, all.count() - first));
      std::iota(items.begin(), items.end(), std::uint32_t(first));
      visit(all.floats_of(items, components));
    }
  }

  static std::string set_name(const TextureSource& source) { return "TEXCOORD_" + std::to_string(source.texcoord_set); }

  /// Finds the coordinates of the normal map and the tangents. The counts do not depend on the scope.
  void find_normal_map(const tinygltf::Primitive& p, const std::string& at, VertexValues& out) {
    const SourceMaterial& m = materials_[std::size_t(out.material)];
    if (m.material.normal_map.texture.image < 0) return;
    const std::string set = set_name(m.normal_map), key = at + ".attributes." + set;
    const auto attribute = p.attributes.find(set);
    if (attribute == p.attributes.end())
      return warnings_.count("normal maps without the texture coordinates that they require, not used", key);
    expect_count(attribute->second, out.position.count(), key);
    find_tangents(p, at, out);
    if (!with_normals_) return;
    out.shares_uv = out.uv && m.normal_map.has_coordinates_of(m.texture);
    if (!out.shares_uv) out.normal_uv.emplace(tile_.path, document_, attribute->second);
  }

  void find_tangents(const tinygltf::Primitive& p, const std::string& at, VertexValues& out) {
    const auto attribute = p.attributes.find("TANGENT");
    if (attribute == p.attributes.end()) return;
    const std::string key = at + ".attributes.TANGENT";
    AccessorItems tangents(tile_.path, document_, attribute->second);
    if (tangents.components() != 4 || tangents.count() != out.position.count())
      return warnings_.count("tangents that do not fit the positions, ignored", key);
    for_each_block(tangents, 4, [&](const std::vector<float>& xyzw) {
      for (const VertexTangent& t : vertex_tangents(xyzw))
        if (t[0] == no_vertex_normal)
          warnings_.count("vertex tangents without a direction, computed from the texture coordinates", key);
    });
    if (with_normals_) out.tangent.emplace(std::move(tangents));
  }

  void add_whole(const Corners& corners, const VertexValues& values, const std::string& at, MeshParts& parts) {
    HeldClaim claim(claim_);
    claim.add_items(values.position.count(), values.bytes_of_vertex(), at, "vertices");
    claim.add_items(corners.triangles() * 3, corner_bytes, at, "corners of triangles");
    add(read_whole(corners, values, materials_[std::size_t(values.material)]), values, at, parts);
    if (!sink_) claim.keep();
  }

  /// Adds the parts of a large primitive. The threads read as many parts at once as fit into a sixteenth of the memory
  /// limit. The error of the first part that has one is thrown.
  void add_parts(const Corners& corners, const VertexValues& values, const std::string& at, MeshParts& parts) {
    const std::uint64_t count = std::max<std::uint64_t>(1, part_count(corners.triangles()));
    const std::uint64_t vertices = values.position.count() / count + 1;
    const std::uint64_t part_bytes = max_part_triangles * 3 * corner_bytes + vertices * values.bytes_of_vertex();
    const auto at_once = std::clamp<std::uint64_t>(memory_limit() / 16 / part_bytes, 1, std::uint64_t(pool_.threads()));
    for (std::uint64_t first = 0; first < count; first += at_once) {
      std::mutex claiming;
      HeldClaim claim(claim_);
      const auto add_claim = [&](std::uint64_t items, std::uint64_t item_bytes, const char* what) {
        const std::scoped_lock lock(claiming);
        claim.add_items(items, item_bytes, at, what);
      };
      std::vector<Primitive> read(std::min(at_once, count - first));
      std::vector<std::exception_ptr> errors(read.size());
      pool_.parallel_for(read.size(), 1, [&](std::size_t i, std::size_t, int) {
        try {
          read[i] = read_part(corners, (first + i) * max_part_triangles, values,
                              materials_[std::size_t(values.material)], add_claim);
        } catch (...) {
          errors[i] = std::current_exception();
        }
      });
      for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
      for (Primitive& part : read) add(std::move(part), values, at, parts);
    }
  }

  void add(Primitive&& primitive, const VertexValues& values, const std::string& at, MeshParts& parts) {
    if (!values.ids || values.ids->texture() != nullptr) return add_part(std::move(primitive), values, parts);
    for (Primitive& part : split_by_class(std::move(primitive), at, warnings_))
      add_part(std::move(part), values, parts);
  }

  void add_part(Primitive&& primitive, const VertexValues& values, MeshParts& parts) {
    primitive.position_step = values.position.quantization_step();
    primitive.material = values.material;
    primitive.shares_uv = values.shares_uv;
    if (const IdTextureSource* ids = values.ids ? values.ids->texture() : nullptr)
      primitive.id_texture = {ids->texture, std::make_shared<const TexelIds>(ids->ids)};
    parts.primitives.push_back(int(out_.primitives.size()));
    if (!sink_) return out_.primitives.push_back(std::move(primitive));
    out_.primitives.push_back(without_lists(primitive));
    sink_(out_.primitives.size() - 1, std::move(primitive));
  }

  void expect_count(int accessor, std::uint64_t vertices, const std::string& at) const {
    const std::uint64_t items = model_.accessors[std::size_t(accessor)].count;
    if (items != vertices)
      throw InputError(tile_.path, at, pluralize(items, "item") + " for " + pluralize(vertices, "vertex", "vertices"));
  }

  /// Copies the images that primitives use. Counts unusable images even if only positions are read, so that the scan
  /// reports them.
  void keep_images() {
    std::set<std::string> faults, map_faults;
    std::vector<char> is_used(document_.images.size());
    for (const Primitive& p : out_.primitives) {
      const SourceMaterial& m = materials_[std::size_t(p.material)];
      if (!m.texture.fault.empty() && faults.insert(m.texture.fault).second)
        warnings_.count_loss("unusable images, replaced by grey", without_file(m.texture.fault));
      if (!m.normal_map.fault.empty() && map_faults.insert(m.normal_map.fault).second)
        warnings_.count_loss("unusable images of normal maps, not used", without_file(m.normal_map.fault));
      for (const int image : {m.material.texture.image, with_normals_ ? m.material.normal_map.texture.image : -1,
                              p.id_texture.texture.image})
        if (image >= 0) is_used[std::size_t(image)] = 1;
    }
    for (std::size_t i = 0; everything_ && i < document_.images.size(); ++i) {
      const std::string key = "images[" + std::to_string(i) + "]";
      claim_.add_items(is_used[i] != 0 ? document_.images[i].size() : 0, 1, key, "bytes of an image");
      out_.images.push_back({tile_.path.string() + ": " + key,
                             is_used[i] != 0 ? document_.images[i].copy() : std::vector<std::uint8_t>()});
    }
  }

  /// Returns the fault without the tile's name, because the list of missing inputs prints the name separately.
  std::string without_file(const std::string& fault) const {
    const std::string file = tile_.path.string() + ": ";
    return fault.starts_with(file) ? fault.substr(file.size()) : fault;
  }

  const TileRef& tile_;
  const PrimitiveSink& sink_;
  const ThreadPool& pool_;
  bool everything_, with_normals_;
  MemoryClaim claim_{tile_.path};
  GltfDocument document_;
  const tinygltf::Model& model_;
  Affine<Scene, World> scene_from_tile_;  ///< RTC_CENTER included
  std::vector<SourceMaterial> materials_;
  std::vector<VoxelClass> classes_of_i3dm_;  ///< 1 per instance, or empty
  std::map<int, MeshParts> meshes_;
  std::set<std::pair<int, TexelIds>> checked_ids_;  ///< images of ids whose texels have been checked
  SourceWarnings warnings_;
  TileMesh out_;
};

}  // namespace

TileMesh read_gltf(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, const PrimitiveSink& sink,
                   const ThreadPool& pool) {
  return TileReader(tile, root, scope, sink, pool).read();
}

}  // namespace gigabake
