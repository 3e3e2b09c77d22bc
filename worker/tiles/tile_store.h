/// Where tiles come from: from their files, or, those that are large beside the memory there is, from scratch.
///
/// A large tile is read once. Its clusters go to a file in the scratch folder that is named by the tile's hash, so that
/// cells, other ranks and a bake that continues later read the clusters that they need, and nothing else of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "format/source/source.h"
#include "lattice/hash128.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/tiles/loaded_tile.h"

namespace gigabake {

struct TileScratch {
  std::filesystem::path folder;       ///< none: every tile is held in memory
  std::uint64_t most_tile_bytes = 0;  ///< of a tile's triangles, or a texture, in memory; more goes to the folder
};

/// Of a rank that may use memory_bytes: a tile's triangles, and a texture, may take a 128th of it in memory; 0:
/// whatever they take. The caches (CellLoader) then hold sixteen of the largest.
TileScratch scratch_in(std::filesystem::path folder, std::uint64_t memory_bytes);

class TileStore {
 public:
  /// `sources` and `parameters` must outlive it.
  TileStore(const SceneSources& sources, const BakeParameters& parameters, TileScratch scratch, int threads);

  /// expected: tile_hash() of what was surveyed; none: whatever the files hold now, in memory.
  /// Several ranks that want the same large tile: one reads it, the others wait for its scratch file.
  /// Errors  InputError, as read_tile(); and where the files do not hold what was surveyed. IoError: the scratch folder
  ///         cannot be written, because its disk is full, say.
  std::shared_ptr<const LoadedTile> load(std::uint32_t tile, const std::optional<Hash128>& expected) const;

  /// Does its file say that it may take more memory than a tile should? It goes to scratch then, where there is one.
  bool may_be_large(std::uint32_t tile) const;
  bool has_scratch() const { return !scratch_.folder.empty(); }

 private:
  std::shared_ptr<const LoadedTile> stored(const std::filesystem::path& file) const;
  std::shared_ptr<const LoadedTile> read(std::uint32_t tile, const std::optional<Hash128>& expected,
                                         const std::filesystem::path& file) const;

  const SceneSources& sources_;
  const BakeParameters& parameters_;
  const TileScratch scratch_;
  const ThreadPool pool_;
};

}  // namespace gigabake
