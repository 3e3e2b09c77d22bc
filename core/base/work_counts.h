/// Counters of the work that this process has done. The counts of a bake are equal on every machine and under every
/// load, so a test compares them with recorded counts (tests/work). Times do not allow this.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/rules.h"

namespace gigabake {

enum class WorkCounter : std::uint8_t {
  files_opened,             ///< sources, shards and scratch files, for reading or writing
  file_bytes_read,          ///< of sources and scratch files
  shard_datasets_opened,    ///< by HDF5, which serves one thread at a time
  shard_rows_read,          ///< rows of all columns of shards, as requested by callers
  shard_bytes_read,         ///< stored bytes of the chunks that contain these rows
  shard_bytes_written,      ///< complete files
  shard_bytes_copied,       ///< of these: chunks that edits of stored shards copied as stored
  edited_bricks,            ///< bricks that edits of stored shards built again
  overview_children,        ///< children of the overviews that were made
  overview_children_read,   ///< children that were read from their shards, not taken from memory
  overview_rows,            ///< node rows of the overviews' children, from memory and from shards
  joins,                    ///< loops whose caller waited for other threads of a pool
  device_bytes_uploaded,    ///< from the host to a device
  device_bytes_downloaded,  ///< from a device to the host
  device_launches,          ///< kernel launches, without those inside of libraries
  device_synchronizations,  ///< calls in which the host waited for a device
  device_allocations,
};
template <>
constexpr auto names_of<WorkCounter>() {
  return std::to_array<std::string_view>({"files_opened", "file_bytes_read", "shard_datasets_opened", "shard_rows_read",
                                          "shard_bytes_read", "shard_bytes_written", "shard_bytes_copied",
                                          "edited_bricks", "overview_children", "overview_children_read",
                                          "overview_rows", "joins", "device_bytes_uploaded", "device_bytes_downloaded",
                                          "device_launches", "device_synchronizations", "device_allocations"});
}

struct WorkCounts {
  std::array<std::uint64_t, names_of<WorkCounter>().size()> counts{};

  std::uint64_t operator[](WorkCounter counter) const { return counts[std::size_t(counter)]; }
  WorkCounts& operator+=(const WorkCounts& other);
  /// Range   Every count of `earlier` is at most the count of this object.
  WorkCounts since(const WorkCounts& earlier) const;
  friend bool operator==(const WorkCounts&, const WorkCounts&) = default;
};

/// Adds to a counter of this process. Thread-safe.
/// Cost    One atomic addition; call it per file, chunk or loop, not per voxel.
void count_work(WorkCounter counter, std::uint64_t amount = 1) noexcept;
/// Returns the counts of this process since its start.
WorkCounts work_counts() noexcept;

}  // namespace gigabake
