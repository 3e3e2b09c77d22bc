/// Collects a tile's primitives while the tile is read. They stay in memory, or go to scratch if the tile is large.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/memory_limit.h"
#include "core/base/thread_pool.h"
#include "format/source/mesh.h"
#include "worker/tiles/tile_directory.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

class TilePrimitiveCollector {
 public:
  struct Limit {
    std::uint64_t max_bytes = 0;         ///< of primitives in memory; above it all go to the file
    std::filesystem::path scratch_file;  ///< empty: all stay in memory
  };
  /// tile: for messages. The pool splits primitives into clusters while the next primitive is read.
  TilePrimitiveCollector(const std::filesystem::path& tile, Limit limit, const ThreadPool& pool);
  ~TilePrimitiveCollector();

  /// Adds a primitive.
  /// Errors  InputError: more than memory_limit() would have to stay in memory. IoError: the scratch file cannot be
  ///         written; it is removed.
  void take(Primitive&& primitive);
  /// Returns all primitives after the last take(): whole and in memory, or in clusters on scratch. The scratch file is
  /// published here. mesh: the tile without its primitives.
  /// Errors  The errors of take().
  TileDirectory finish(TileMesh&& mesh);
  bool is_on_scratch() const { return writer_.has_value(); }

 private:
  void cut_pending();
  void wait();
  void cut(const std::vector<Primitive>& batch);

  const Limit limit_;
  const ThreadPool& pool_;
  MemoryClaim claim_;
  std::uint64_t bytes_ = 0;         ///< of pending_
  std::vector<Primitive> pending_;  ///< in memory, not yet split into clusters
  std::optional<TileFileWriter> writer_;
  std::vector<TilePrimitive> cut_;  ///< primitives in the file
  /// Buffers of the batch that is being split, one per primitive. The next batch reuses them, because clearing new
  /// pages took a sixth of the time.
  std::vector<std::vector<std::uint8_t>> cut_bytes_;
  std::future<void> cutting_;  ///< of the last batch
};

}  // namespace gigabake
