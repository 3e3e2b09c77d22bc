#include "worker/pipeline/cell_loader.h"

#include <algorithm>

#include "core/base/error.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "worker/edit/edited_mesh.h"
#include "worker/pipeline/lattice.h"
#include "worker/scan/long_triangles.h"
#include "worker/tiles/clusters.h"

namespace gigabake {
namespace {

template <class T>
Span<const T> span(const std::vector<T>& v) {
  return {v.data(), v.size()};
}

/// Index of a material in the cell, and its normal map.
struct CellMaterial {
  std::int64_t index = -1;            ///< -1: not added yet
  int normal_image = -1;              ///< index into TileMesh::images, or -1
  kernels::NormalMapView normal_map;  ///< without texture until a part needs it
};

/// Returns the class of a placed primitive: that of ids, else of its material's name, else of the source.
VoxelClass class_of(const Instance& instance, const Primitive& primitive, const Material& material,
                    const SourceClasses* classes) {
  for (const std::int32_t stated : {instance.voxel_class, primitive.voxel_class, material.voxel_class})
    if (stated != not_stated) return VoxelClass(stated);
  return classes == nullptr ? no_class : classes->of_source;
}

kernels::PartView part_view(const Primitive& primitive, const Instance& instance, const CellMaterial& material, int lod,
                            VoxelClass voxel_class, const kernels::IdTextureView* id_texture) {
  kernels::PartView part{span(primitive.position),
                         span(primitive.index),
                         span(primitive.uv),
                         span(primitive.rgba),
                         span(primitive.normal),
                         {},
                         std::uint32_t(material.index),
                         material.normal_map,
                         span(primitive.shares_uv ? primitive.uv : primitive.normal_uv),
                         span(primitive.tangent),
                         lod,
                         voxel_class,
                         id_texture,
                         span(primitive.id_uv)};
  std::ranges::copy(row_major(instance.scene_from_local), part.scene_from_local);
  return part;
}

/// Returns the box that contains each surface before the edits that is in `cell` after them. An edit may move
/// surfaces of any height.
Box3i64 box_before(const SourceEditsInScene& edits, Box3i64 cell) {
  constexpr std::int64_t any_height = std::int64_t(1) << 45;
  const auto moves = [](const SourceEditInScene& edit) { return edit.moves(); };
  if (std::none_of(edits.begin(), edits.end(), moves)) return cell;
  cell.min[2] = -any_height, cell.end[2] = any_height;
  return cell;
}

}  // namespace

kernels::CellInput LoadedCell::input() const { return {span(parts), span(materials), span(texture_views)}; }

CellLoader::CellLoader(const SceneSources& sources, const BakeParameters& parameters, std::uint64_t cache_bytes,
                       int threads, const TileScratch& scratch)
    : sources_(sources),
      parameters_(parameters),
      pool_(threads),
      tile_store_(sources, parameters, scratch, threads),
      texture_store_(scratch.folder, scratch.max_tile_bytes),
      tiles_(cache_bytes / 2),
      textures_(cache_bytes / 2) {}

/// The textures of a cell in the order of first use, without duplicates.
struct CellLoader::RequiredTextures {
  struct Item {
    TextureKey key;
    const LoadedTile* tile;
    std::size_t image;
  };
  std::vector<Item> items;

  std::int32_t index_of(const LoadedTile& tile, std::size_t image, const TextureFilterKey& filter_key) {
    const TextureKey key{tile.images().at(image).hash, filter_key};
    const auto [at, is_new] = index_.try_emplace(key, std::int32_t(items.size()));
    if (is_new) items.push_back({key, &tile, image});
    return at->second;
  }

 private:
  std::unordered_map<TextureKey, std::int32_t, TextureKeyHash> index_;
};

CellLoader::TileKey CellLoader::key_of(const CellJob& job, std::size_t tile) {
  TileKey key{job.tiles[tile], {}};
  if (!job.tile_sources.empty()) key.source = job.tile_sources.at(tile);
  return key;
}

LoadedCell CellLoader::load(const CellJob& job) {
  try {
    return load_whole(job);
  } catch (const IoError&) {
    for (std::size_t i = 0; i < job.tiles.size(); ++i) tiles_.drop(key_of(job, i));
    throw;
  }
}

LoadedCell CellLoader::load_whole(const CellJob& job) {
  LoadedCell cell;
  cell.memory = MemoryClaim("cell " + job.name, cell_advice);
  load_tiles(job, cell);
  RequiredTextures wanted;
  for (std::size_t i = 0; i < cell.tiles.size(); ++i) {
    const SourceEdits* edits = sources_.tiles.at(job.tiles[i]).edits.get();
    const SourceEditsInScene placed = edits == nullptr ? SourceEditsInScene() : placed_edits(*edits, sources_.origin);
    add_parts(job, *cell.tiles[i], sources_.tiles.at(job.tiles[i]), placed, cell, wanted);
  }
  load_textures(wanted, cell);
  return cell;
}

void CellLoader::load_tiles(const CellJob& job, LoadedCell& cell) {
  cell.tiles.resize(job.tiles.size());
  pool_.parallel_for(job.tiles.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const TileKey key = key_of(job, i);
      cell.tiles[i] = tiles_.get(key, [&] { return tile_store_.load(key.tile, key.source); });
    }
  });
}

void CellLoader::add_parts(const CellJob& job, const LoadedTile& tile, const TileRef& source,
                           const SourceEditsInScene& edits, LoadedCell& cell, RequiredTextures& wanted) const {
  const Box3i64 box = box_before(edits, Box3i64::cube(job.lattice_min, job.cell_voxels));
  const TileMesh& mesh = tile.mesh();
  std::vector<CellMaterial> cell_materials(mesh.materials.size());
  const auto add_material = [&](const Material& material) {
    ShadedMaterial shaded = shaded_material(material);
    if (shaded.image >= 0) shaded.view.texture = wanted.index_of(tile, std::size_t(shaded.image), shaded.filter_key);
    cell.materials.push_back(shaded.view);
    return CellMaterial{std::int64_t(cell.materials.size()) - 1, shaded.normal_image, shaded.normal_map};
  };
  for (std::size_t i = 0; i < mesh.instances.size(); ++i) {
    const SceneBox& reach = tile.instance_boxes()[i];
    if (!may_overlap(reach, parameters_, box)) continue;
    const Instance& instance = mesh.instances[i];
    std::shared_ptr<const Primitive> near = mesh_near(box, tile, instance, cell.memory);
    if (near != nullptr) near = edited_mesh(std::move(near), instance.scene_from_local, edits, cell.memory);
    if (near == nullptr) continue;
    const Primitive& shell = mesh.primitives[std::size_t(instance.primitive)];
    const std::size_t of_tile = std::size_t(shell.material);
    const int lod = lod_of(instance, source);
    CellMaterial& material = cell_materials[of_tile];
    if (material.index < 0) material = add_material(mesh.materials[of_tile]);
    if (material.normal_image >= 0 && (near->shares_uv || !near->normal_uv.empty()))
      material.normal_map.texture = wanted.index_of(tile, std::size_t(material.normal_image), normal_map_filter);
    const VoxelClass voxel_class = class_of(instance, shell, mesh.materials[of_tile], source.classes.get());
    const kernels::IdTextureView* ids = nullptr;
    if (const TextureUse& use = shell.id_texture.texture; !near->id_uv.empty())
      ids = &cell.id_textures.emplace_back(wanted.index_of(tile, std::size_t(use.image), id_texture_filter), use.wrap_s,
                                           use.wrap_t, *shell.id_texture.ids);
    cell.parts.push_back(part_view(*near, instance, material, lod, voxel_class, ids));
    if (may_have_long_triangle(reach, parameters_)) {
      cell.memory.add_items(near->index.size(), sizeof(std::uint32_t), "", "corners of triangles");
      cell.indices.push_back(index_without_long(*near, instance, parameters_, lod));
      cell.parts.back().index = span(cell.indices.back());
    }
    cell.meshes.push_back(std::move(near));
  }
}

/// Returns the whole primitive if it is not split into clusters. Otherwise returns its clusters near the cell as one
/// mesh; null if no cluster is near. Claims the memory of one kernel part and of its triangles.
std::shared_ptr<const Primitive> CellLoader::mesh_near(const Box3i64& box, const LoadedTile& tile,
                                                       const Instance& instance, MemoryClaim& memory) const {
  constexpr std::uint64_t part_bytes = sizeof(kernels::PartView) + 320, triangle_bytes = 128, max_counted = 64;
  const TilePrimitive& primitive = tile.primitives()[std::size_t(instance.primitive)];
  memory.add_items(1, part_bytes + triangle_bytes * std::min(primitive.triangles, max_counted), "",
                   "meshes of the cell");
  if (primitive.clusters.size() == 1) return tile.mesh_of({&primitive.clusters.front()});
  std::vector<const TileCluster*> near;
  for (const TileCluster& cluster : primitive.clusters)
    if (may_overlap(scene_box(cluster.bounds, instance, parameters_), parameters_, box)) near.push_back(&cluster);
  memory.add_items(near.size(), cluster_bytes, "", "clusters of triangles");
  return tile.mesh_of(near);
}

void CellLoader::load_textures(const RequiredTextures& wanted, LoadedCell& cell) {
  const auto bytes = [](const RequiredTextures::Item& item) { return item.tile->images()[item.image].texture_bytes; };
  for (const RequiredTextures::Item& item : wanted.items)  // mapped textures need no claim: their pages can be evicted
    if (!texture_store_.is_on_scratch(bytes(item))) cell.memory.add(bytes(item), "", "the textures of the cell");
  cell.textures.resize(wanted.items.size());
  pool_.parallel_for(wanted.items.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const RequiredTextures::Item& item = wanted.items[i];
      cell.textures[i] = textures_.get(item.key, [&] {
        return texture_store_.load(item.key, bytes(item), [&] { return item.tile->encoded(item.image); });
      });
    }
  });
  for (const auto& texture : cell.textures) cell.texture_views.push_back(texture->view());
}

}  // namespace gigabake
