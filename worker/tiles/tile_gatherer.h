/// Takes a tile's primitives while it is read, and keeps them: in memory, or those of a large tile on scratch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "format/source/mesh.h"
#include "lattice/memory_limit.h"
#include "lattice/thread_pool.h"
#include "worker/tiles/tile_directory.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

class TileGatherer {
 public:
  struct Limit {
    std::uint64_t most_bytes = 0;        ///< of primitives in memory: with more, all go to the file
    std::filesystem::path scratch_file;  ///< none: all stay in memory
  };
  /// tile: for messages. The pool cuts clusters while the next primitive is read.
  TileGatherer(const std::filesystem::path& tile, Limit limit, const ThreadPool& pool);
  ~TileGatherer();

  /// Errors  InputError: more than memory_limit() has to stay in memory. IoError: the scratch file cannot be written;
  ///         it is gone then.
  void take(Primitive&& primitive);
  /// After the last one: all of them, whole and in memory, or in clusters on scratch. `mesh` is what is left of the
  /// tile; the file appears here. Errors  As take().
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
  std::vector<Primitive> pending_;  ///< in memory, not yet cut
  std::optional<TileFileWriter> writer_;
  std::vector<TilePrimitive> cut_;  ///< in the file
  /// Of the batch that is being cut, one a primitive: the next batch uses their memory again. To clear new pages took
  /// a sixth of the time.
  std::vector<std::vector<std::uint8_t>> cut_bytes_;
  std::future<void> cutting_;  ///< of the last batch
};

}  // namespace gigabake
