/// Unpacked chunks of open files. A page needs few rows of a chunk, and other pages often need other rows of it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "format/system/loading_cache.h"

namespace gigabake {

/// A cache of unpacked chunks, bounded in bytes. Evicts the least recently used chunks. Thread-safe: threads that need
/// the same chunk wait until one of them has unpacked it.
class ChunkCache {
 public:
  struct Chunk {
    std::vector<std::uint8_t> raw;
    std::uint64_t bytes() const { return raw.size(); }
  };

  explicit ChunkCache(std::uint64_t max_bytes) : chunks_(max_bytes) {}

  /// Returns a number for a column of an open file, which no other column has.
  std::uint64_t add_column() { return columns_++; }

  /// Returns a chunk. If it is absent, calls `load()`, which returns a std::shared_ptr<const Chunk>.
  /// Errors  The exceptions of load().
  template <class Load>
  std::shared_ptr<const Chunk> get(std::uint64_t column, std::uint64_t index, const Load& load) {
    return chunks_.get({column, index}, load);
  }

 private:
  struct Key {
    std::uint64_t column, index;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      return std::size_t((key.column << 32 ^ key.index) * 0x9e3779b97f4a7c15u >> 16);
    }
  };

  std::atomic<std::uint64_t> columns_{0};
  LoadingCache<Key, Chunk, KeyHash> chunks_;
};

}  // namespace gigabake
