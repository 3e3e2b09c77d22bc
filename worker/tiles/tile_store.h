/// Loads tiles from their source files, or from scratch if they are large compared with the memory.
///
/// A large tile is read once. Its clusters are written to a scratch file whose name contains the tile's hash. Cells,
/// other ranks and a resumed bake read only the clusters that they need.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "core/base/thread_pool.h"
#include "core/io/hash128.h"
#include "core/octree/parameters.h"
#include "format/source/source.h"
#include "format/system/file_stamp.h"
#include "worker/tiles/loaded_tile.h"

namespace gigabake {

struct TileScratch {
  std::filesystem::path folder;  ///< empty: every tile is held in memory
  /// Max size in memory of a tile's triangles, or of a texture. Larger ones are written to scratch.
  std::uint64_t max_tile_bytes = 0;
};

/// Returns the limits of a rank with `memory_bytes`. A tile's triangles, or a texture, may take 1/128 of
/// `memory_bytes`; 0 means no limit. Each cache of CellLoader then holds sixteen tiles or textures of the max size.
TileScratch scratch_in(std::filesystem::path folder, std::uint64_t memory_bytes);

class TileStore {
 public:
  /// `sources` and `parameters` must outlive the store.
  TileStore(const SceneSources& sources, const BakeParameters& parameters, TileScratch scratch, int threads);

  /// Loads a tile. If several ranks need the same large tile, one reads it and the others wait for its scratch file.
  /// `expected` is tile_hash() at the scan; if it is nullopt, the current content of the files is loaded into memory.
  /// `hashed` are the files from which the caller has just computed `expected`, with their stamps: if these have not
  /// changed, the files are not hashed again after they were read.
  /// Errors  The errors of read_tile(). InputError: the files changed since the scan. IoError: the scratch folder
  ///         cannot be written, for example because its disk is full.
  std::shared_ptr<const LoadedTile> load(std::uint32_t tile, const std::optional<Hash128>& expected,
                                         std::span<const StampedFile> hashed = {}) const;

  /// Returns true if the source file is so large that the tile may exceed the memory limit per tile. Such a tile goes
  /// to scratch if there is a scratch folder.
  bool may_be_large(std::uint32_t tile) const;
  bool has_scratch() const { return !scratch_.folder.empty(); }

 private:
  std::shared_ptr<const LoadedTile> stored(const std::filesystem::path& file) const;
  std::shared_ptr<const LoadedTile> read(std::uint32_t tile, const std::optional<Hash128>& expected,
                                         std::span<const StampedFile> hashed, const std::filesystem::path& file) const;

  const SceneSources& sources_;
  const BakeParameters& parameters_;
  const TileScratch scratch_;
  const ThreadPool pool_;
};

}  // namespace gigabake
