/// First stage of a cell: loads all data that the kernels read. Data is read, decoded and prefiltered, or taken from
/// the cache.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/memory_limit.h"
#include "core/math/box3.h"
#include "core/octree/parameters.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/job/cell_job.h"
#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/system/loading_cache.h"
#include "kernels/body/texture/id_texture_view.h"
#include "kernels/cpu/bake_cell.h"
#include "worker/tiles/loaded_tile.h"
#include "worker/tiles/texture_store.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {

inline constexpr const char* cell_advice = "use a smaller `cell_voxels`";

/// The input of bake_cell() and the owners of its memory. Move-only.
struct LoadedCell {
  /// The claimed memory of instances and textures. The memory of tiles is claimed while the tiles are read.
  MemoryClaim memory{"cell", cell_advice};
  std::vector<std::shared_ptr<const LoadedTile>> tiles;
  /// The meshes of `parts`: whole primitives, or the clusters near the cell.
  std::vector<std::shared_ptr<const Primitive>> meshes;
  std::vector<std::shared_ptr<const CellTexture>> textures;
  /// Index lists without triangles that are too long, for the parts that may have such triangles.
  std::vector<std::vector<std::uint32_t>> indices;
  std::deque<kernels::IdTextureView> id_textures;  ///< a deque: parts refer to its elements
  std::vector<kernels::PartView> parts;
  std::vector<kernels::MaterialView> materials;
  std::vector<kernels::TextureView> texture_views;

  kernels::CellInput input() const;
};

class CellLoader {
 public:
  /// `sources` and `parameters` must outlive the loader. Caches hold at most `cache_bytes`, half for tiles and half for
  /// textures. Data that only cells in flight use does not count. Tiles and textures above scratch.max_tile_bytes are
  /// stored in scratch.folder.
  CellLoader(const SceneSources& sources, const BakeParameters& parameters, std::uint64_t cache_bytes, int threads,
             const TileScratch& scratch = {});

  /// Loads a cell, and applies the edits of its sources (worker/edit/edited_mesh.h). Omits instances and clusters whose
  /// bounds do not overlap the cell, and images that only omitted instances use. Also omits triangles that are too long
  /// (worker/scan/long_triangles.h); this test does not depend on the cell.
  /// Cost    Proportional to the data near the cell, plus one comparison per instance in the cell's tiles and per
  ///         cluster of the instances near the cell.
  /// Exact   If job.tile_sources is not empty, each tile's hash is verified when the tile is read, and is part of the
  ///         tile's cache key.
  /// Errors  InputError if a tile or image cannot be read, or a tile has changed since its scan. IoError if scratch
  ///         cannot be written or is corrupt; another attempt then reads the tiles again.
  LoadedCell load(const CellJob& job);

 private:
  /// Key of a cached tile. A changed tile gets a new entry; the old one is evicted eventually.
  struct TileKey {
    std::uint32_t tile;
    std::optional<Hash128> source;
    friend bool operator==(const TileKey&, const TileKey&) = default;
  };
  struct TileKeyHash {
    std::size_t operator()(const TileKey& key) const { return key.tile; }
  };
  struct RequiredTextures;

  static TileKey key_of(const CellJob& job, std::size_t tile);
  LoadedCell load_whole(const CellJob& job);
  void load_tiles(const CellJob& job, LoadedCell& cell);
  /// Adds the parts of a tile, with the level and classes of its source.
  void add_parts(const CellJob& job, const LoadedTile& tile, const TileRef& source, const SourceEditsInScene& edits,
                 LoadedCell& cell, RequiredTextures& wanted) const;
  std::shared_ptr<const Primitive> mesh_near(const Box3i64& box, const LoadedTile& tile, const Instance& instance,
                                             MemoryClaim& memory) const;
  void load_textures(const RequiredTextures& wanted, LoadedCell& cell);

  const SceneSources& sources_;
  const BakeParameters& parameters_;
  ThreadPool pool_;
  TileStore tile_store_;  ///< has its own threads, because tiles are read concurrently on pool_
  TextureStore texture_store_;
  LoadingCache<TileKey, LoadedTile, TileKeyHash> tiles_;
  LoadingCache<TextureKey, CellTexture, TextureKeyHash> textures_;
};

}  // namespace gigabake
