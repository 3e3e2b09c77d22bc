#include "worker/cell_loader.h"

#include <algorithm>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/source/image/image_size.h"
#include "format/source/tile_hash.h"
#include "lattice/error.h"
#include "worker/far_triangles.h"
#include "worker/lattice.h"

namespace gigabake {
namespace {

Hash128 hash_of(const std::vector<std::uint8_t>& bytes) {
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  return {h.low64, h.high64};
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

template <class T>
Span<const T> span(const std::vector<T>& v) {
  return {v.data(), v.size()};
}

kernels::PartView part_view(const Primitive& primitive, const Instance& instance, std::uint32_t material) {
  kernels::PartView part{
      span(primitive.position), span(primitive.index), span(primitive.uv), span(primitive.rgba), {}, material};
  std::ranges::copy(row_major(instance.scene_from_local), part.scene_from_local);
  return part;
}

/// Filtering needs no threads of its own: textures are loaded side by side.
std::shared_ptr<const kernels::Texture> make_texture(const EncodedImage& encoded, const TextureRecipe& recipe) {
  Image image = decode_image(encoded);
  return std::make_shared<const kernels::Texture>(std::move(image.rgba), image.width, image.height, recipe.alpha,
                                                  recipe.mask_cutoff, ThreadPool(1));
}

}  // namespace

std::shared_ptr<const LoadedTile> LoadedTile::read(const TileRef& tile, const SceneSources& sources,
                                                   const std::optional<Hash128>& expected) {
  auto loaded = std::make_shared<LoadedTile>();
  loaded->mesh = read_tile(tile, sources.root, ReadScope::everything);
  // Compared after it was read: a file that is replaced meanwhile is caught too.
  if (expected && tile_hash(tile, sources.root) != *expected)
    throw InputError(tile.path, "", "changed while the bake ran; bake again");
  for (const Primitive& primitive : loaded->mesh.primitives) loaded->bounds.push_back(bounds_of(primitive));
  for (const EncodedImage& image : loaded->mesh.images) loaded->image_hash.push_back(hash_of(image.bytes));
  return loaded;
}

std::uint64_t LoadedTile::bytes() const {
  std::uint64_t sum =
      sizeof(*this) + bytes_of(mesh.instances) + bytes_of(mesh.materials) + bytes_of(bounds) + bytes_of(image_hash);
  for (const Primitive& p : mesh.primitives)
    sum += sizeof(p) + bytes_of(p.position) + bytes_of(p.index) + bytes_of(p.uv) + bytes_of(p.rgba);
  for (const EncodedImage& image : mesh.images) sum += sizeof(image) + image.bytes.capacity();
  return sum;
}

kernels::CellInput LoadedCell::input() const { return {span(parts), span(materials), span(texture_views)}; }

CellLoader::CellLoader(const SceneSources& sources, const BakeParameters& parameters, std::uint64_t cache_bytes,
                       int threads)
    : sources_(sources), parameters_(parameters), pool_(threads), tiles_(cache_bytes / 2), textures_(cache_bytes / 2) {}

/// The textures of a cell in the order of their first use, each once.
struct CellLoader::WantedTextures {
  struct Item {
    TextureKey key;
    const EncodedImage* image;
  };
  std::vector<Item> items;

  std::int32_t index_of(const TextureKey& key, const EncodedImage& image) {
    const auto [at, is_new] = index_.try_emplace(key, std::int32_t(items.size()));
    if (is_new) items.push_back({key, &image});
    return at->second;
  }

 private:
  std::unordered_map<TextureKey, std::int32_t, TextureKeyHash> index_;
};

LoadedCell CellLoader::load(const CellJob& job) {
  LoadedCell cell;
  cell.memory = MemoryClaim("cell " + job.name, cell_advice);
  load_tiles(job, cell);
  WantedTextures wanted;
  for (const auto& tile : cell.tiles) add_parts(job, *tile, cell, wanted);
  load_textures(wanted, cell);
  return cell;
}

void CellLoader::load_tiles(const CellJob& job, LoadedCell& cell) {
  cell.tiles.resize(job.tiles.size());
  pool_.parallel_for(job.tiles.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      TileKey key{job.tiles[i], {}};
      if (!job.tile_sources.empty()) key.source = job.tile_sources.at(i);
      cell.tiles[i] =
          tiles_.get(key, [&] { return LoadedTile::read(sources_.tiles.at(key.tile), sources_, key.source); });
    }
  });
}

void CellLoader::add_parts(const CellJob& job, const LoadedTile& tile, LoadedCell& cell, WantedTextures& wanted) const {
  std::vector<std::int64_t> cell_material(tile.mesh.materials.size(), -1);
  const auto add_material = [&](const Material& material) {
    ShadedMaterial shaded = shaded_material(material);
    if (shaded.image >= 0) {
      const std::size_t image = std::size_t(shaded.image);
      shaded.view.texture = wanted.index_of({tile.image_hash.at(image), shaded.recipe}, tile.mesh.images[image]);
    }
    cell.materials.push_back(shaded.view);
    return std::int64_t(cell.materials.size()) - 1;
  };
  for (const Instance* near : instances_near(job, tile, cell.memory)) {
    const Instance& instance = *near;
    const Primitive& primitive = tile.mesh.primitives[std::size_t(instance.primitive)];
    std::int64_t& material = cell_material[std::size_t(primitive.material)];
    if (material < 0) material = add_material(tile.mesh.materials[std::size_t(primitive.material)]);
    cell.parts.push_back(part_view(primitive, instance, std::uint32_t(material)));
    const SceneBox reach = scene_box(tile.bounds[std::size_t(instance.primitive)], instance, parameters_);
    if (!may_reach_too_far(reach, parameters_)) continue;
    cell.memory.add_items(primitive.index.size(), sizeof(std::uint32_t), "", "corners of triangles");
    cell.indices.push_back(index_without_far(primitive, instance, parameters_));
    cell.parts.back().index = span(cell.indices.back());
  }
}

/// Of those that come near the cell, each is a part of it, and the kernels hold triangles of every part.
std::vector<const Instance*> CellLoader::instances_near(const CellJob& job, const LoadedTile& tile,
                                                        MemoryClaim& memory) const {
  constexpr std::uint64_t part_bytes = sizeof(kernels::PartView) + 320, triangle_bytes = 128, most_counted = 64;
  const CellBox box{job.lattice_min, job.cell_voxels};
  std::vector<const Instance*> near;
  for (const Instance& instance : tile.mesh.instances) {
    const std::size_t p = std::size_t(instance.primitive);
    if (!may_meet(tile.bounds[p], instance, parameters_, box)) continue;
    const std::uint64_t triangles = tile.mesh.primitives[p].index.size() / 3;
    memory.add_items(1, part_bytes + triangle_bytes * std::min(triangles, most_counted), "",
                     "what is placed in the cell");
    near.push_back(&instance);
  }
  return near;
}

void CellLoader::load_textures(const WantedTextures& wanted, LoadedCell& cell) {
  for (const WantedTextures::Item& item : wanted.items)
    cell.memory.add(image_size(*item.image).texture_bytes(), "", "the textures of the cell");
  cell.textures.resize(wanted.items.size());
  pool_.parallel_for(wanted.items.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const WantedTextures::Item& item = wanted.items[i];
      cell.textures[i] = textures_.get(item.key, [&] { return make_texture(*item.image, item.key.recipe); });
    }
  });
  for (const auto& texture : cell.textures) cell.texture_views.push_back(texture->view());
}

}  // namespace gigabake
