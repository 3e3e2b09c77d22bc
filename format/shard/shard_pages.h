/// A shard file held open, of which any part of the node table and of the levels is read by itself, by several threads
/// at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Exact   What is given is the same part of what ShardReader reads. Each part is checked as strictly as the whole, but
///         for keys (which are not read) and for where a block's voxels begin, which must only lie inside of the
///         columns.
/// Cost    Reads the chunks that hold the part; once for nodes, and for all else too, three bytes for each node.
/// Errors  InputError naming file and dataset, from every member.
class ShardPages {
 public:
  explicit ShardPages(const std::filesystem::path& path);
  ~ShardPages();

  const ShardHeader& header() const { return header_; }
  std::uint64_t node_rows() const;
  std::uint64_t bricks(int lod) const;

  /// Rows from `first` on: `count`, or as many as there are. Errors  also where there is no row `first`.
  std::vector<NodeRow> nodes(std::uint64_t first, std::uint32_t count) const;
  /// Bricks from `first` on: `count`, or as many as there are. Errors  also where there is no brick `first`.
  /// Range   count ≤ most_bricks.
  BrickBlock level(int lod, std::uint64_t first, std::uint32_t count) const;
  static constexpr std::uint32_t most_bricks = 1u << 22;  ///< of a block: its voxels are counted in 32 bits

 private:
  struct Nodes;
  struct Level;
  const Nodes& open_nodes() const;
  const Level& open_level(int lod) const;

  Hdf5File file_;
  ShardHeader header_;
  std::int32_t version_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Nodes> nodes_;                ///< from the first use on
  mutable std::vector<std::unique_ptr<Level>> levels_;  ///< by lod, likewise
};

}  // namespace gigabake
