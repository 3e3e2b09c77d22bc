/// Collects a tile's primitives while the tile is read. The primitives stay in memory, or are written to scratch if the
/// tile is large.
#pragma once

#include <array>
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
    /// Max bytes of primitives in memory. Above this size, all primitives of the tile are written to the scratch file.
    std::uint64_t max_bytes = 0;
    std::filesystem::path scratch_file;  ///< if empty, all primitives stay in memory
  };
  /// `tile` is the path for messages. The pool splits primitives into clusters while the next primitive is read.
  TilePrimitiveCollector(const std::filesystem::path& tile, Limit limit, const ThreadPool& pool);
  ~TilePrimitiveCollector();

  /// Adds a primitive.
  /// Errors  InputError if the primitives in memory exceed memory_limit(). IoError if the scratch file cannot be
  ///         written; the incomplete file is then removed.
  void take(Primitive&& primitive);
  /// Returns the tile's directory; call it after the last take(). The primitives are whole in memory, or in clusters in
  /// the scratch file. In the second case, finish() publishes the scratch file. `mesh` is the tile without its
  /// primitives.
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
  std::uint64_t bytes_ = 0;         ///< size of pending_ in bytes
  std::vector<Primitive> pending_;  ///< in memory, not yet split into clusters
  std::optional<TileFileWriter> writer_;
  std::vector<TilePrimitive> cut_;  ///< primitives in the file
  /// Buffers of the batches that are being split and written, one per primitive. Later batches reuse them, because
  /// zeroing newly allocated pages would take a sixth of the time.
  std::array<std::vector<std::vector<std::uint8_t>>, 2> cut_bytes_;
  std::size_t cut_batches_ = 0;
  std::future<void> writing_;  ///< started by cutting_; ends when the batch is written
  std::future<void> cutting_;  ///< ends when the last batch is split and its writing has begun
};

}  // namespace gigabake
