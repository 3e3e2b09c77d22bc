/// First stage of a cell: everything the kernels borrow for it, read, decoded and prefiltered, or still in the cache
/// from the cell before.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "format/source/mesh.h"
#include "format/source/source.h"
#include "kernels/cpu/bake_cell.h"
#include "lattice/memory_limit.h"
#include "lattice/parameters.h"
#include "worker/lru_cache.h"
#include "worker/tiles/loaded_tile.h"
#include "worker/tiles/texture_store.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {

inline constexpr const char* cell_advice = "take a smaller `cell_voxels`";

/// What bake_cell() borrows, and those who own it. Move-only.
struct LoadedCell {
  MemoryClaim memory{"cell",
                     cell_advice};  ///< of instances and textures; what tiles take was claimed as they were read
  std::vector<std::shared_ptr<const LoadedTile>> tiles;
  std::vector<std::shared_ptr<const Primitive>> meshes;  ///< of parts: as tiles have them, or clusters near the cell
  std::vector<std::shared_ptr<const CellTexture>> textures;
  std::vector<std::vector<std::uint32_t>> indices;  ///< of parts that have triangles which reach too far: without those
  std::vector<kernels::PartView> parts;
  std::vector<kernels::MaterialView> materials;
  std::vector<kernels::TextureView> texture_views;

  kernels::CellInput input() const;
};

class CellLoader {
 public:
  /// `sources` and `parameters` must outlive the loader. Caches keep at most `cache_bytes`, half for tiles and half for
  /// textures; what cells in hand hold on to comes on top. scratch: for tiles that are larger than its limit.
  CellLoader(const SceneSources& sources, const BakeParameters& parameters, std::uint64_t cache_bytes, int threads,
             const TileScratch& scratch = {});

  /// Instances and clusters whose bounds miss the cell are left out, and with them images that nothing else needs. So
  /// are triangles that reach too far (worker/far_triangles.h), whatever the cell.
  /// Cost    Follows what is near the cell, but for a comparison for each instance of its tiles and each cluster of
  ///         those near.
  /// Exact   What job.tile_sources names, where it names anything: a tile is compared when it is read, and the cache
  ///         knows which one it holds.
  /// Errors  InputError naming the tile or image that cannot be read, or the tile that changed since its survey.
  ///         IoError: scratch that cannot be written, or does not hold what was written; another try reads the tiles
  ///         anew.
  LoadedCell load(const CellJob& job);

 private:
  /// A tile that changed is another entry, and the old one ages.
  struct TileKey {
    std::uint32_t tile;
    std::optional<Hash128> source;
    friend bool operator==(const TileKey&, const TileKey&) = default;
  };
  struct TileKeyHash {
    std::size_t operator()(const TileKey& key) const { return key.tile; }
  };
  struct WantedTextures;

  static TileKey key_of(const CellJob& job, std::size_t tile);
  LoadedCell load_whole(const CellJob& job);
  void load_tiles(const CellJob& job, LoadedCell& cell);
  void add_parts(const CellJob& job, const LoadedTile& tile, LoadedCell& cell, WantedTextures& wanted) const;
  std::shared_ptr<const Primitive> mesh_near(const CellBox& box, const LoadedTile& tile, const Instance& instance,
                                             MemoryClaim& memory) const;
  void load_textures(const WantedTextures& wanted, LoadedCell& cell);

  const BakeParameters& parameters_;
  ThreadPool pool_;
  TileStore tile_store_;  ///< with threads of its own: tiles are read side by side on pool_
  TextureStore texture_store_;
  LruCache<TileKey, LoadedTile, TileKeyHash> tiles_;
  LruCache<TextureKey, CellTexture, TextureKeyHash> textures_;
};

}  // namespace gigabake
