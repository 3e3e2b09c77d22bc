/// An open shard file whose node table and levels are read in parts. Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "format/shard/columns/predicted_level.h"
#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Reader of parts of a shard.
/// Exact   Returns the same values as ShardReader. Checks each part as strictly as the complete shard, with two
///         exceptions. Keys are not read. The position of a block's first voxel is only checked to lie inside the
///         columns.
/// Cost    Reads the chunks that contain the requested part. The first call also reads three bytes per node, and two of
///         them stay in memory. Since version 7 a block of bricks also needs their ancestors: up to a third more
///         voxels. Two blocks of 512 ancestors per level stay in
///         memory.
/// Errors  InputError naming file and dataset, from every member.
class ShardPages {
 public:
  /// `chunks` keeps unpacked chunks of several shards; null: each call unpacks its chunks.
  explicit ShardPages(const std::filesystem::path& path, std::shared_ptr<ChunkCache> chunks = {});
  ~ShardPages();

  const ShardHeader& header() const { return header_; }
  std::uint64_t node_rows() const;
  std::uint64_t bricks(int lod) const;

  /// Returns up to `count` rows, starting at `first`; fewer at the end of the table.
  /// Errors  InputError also if row `first` does not exist.
  std::vector<NodeRow> nodes(std::uint64_t first, std::uint32_t count) const;
  /// Returns up to `count` bricks, starting at `first`; fewer at the end of the level.
  /// Range   count ≤ max_bricks.
  /// Errors  InputError also if brick `first` does not exist.
  BrickBlock level(int lod, std::uint64_t first, std::uint32_t count) const;
  static constexpr std::uint32_t max_bricks = 1u << 22;  ///< limit of a block, whose voxels are counted in 32 bits

 private:
  struct Nodes;
  struct ValueLevel;
  struct Level;
  struct DecodedBricks;
  const Nodes& open_nodes() const;
  const Level& open_level(int lod) const;
  BrickBlock read_values(int lod, std::uint64_t first, std::uint64_t bricks) const;
  BrickBlock cut_out(int lod, std::uint64_t first, std::uint64_t bricks) const;
  BrickLevel decode(int lod, std::uint64_t begin, std::uint64_t count, PredictedLevel::Values values) const;
  DecodedBricks decoded(int lod, std::uint64_t low, std::uint64_t end) const;

  Hdf5File file_;
  ShardHeader header_;
  std::int32_t version_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Nodes> nodes_;                ///< opened at the first use
  mutable std::vector<std::unique_ptr<Level>> levels_;  ///< [lod], opened at the first use
};

}  // namespace gigabake
