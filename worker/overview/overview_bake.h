/// Makes an overview from its children's shards, for bakes and for verification.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "format/shard/packed_shard.h"
#include "kernels/body/cell.h"
#include "worker/overview/duplicated_levels.h"

namespace gigabake {

/// The data of a child's shard that an overview needs.
struct OverviewChild {
  DownsampleState source;
  ChildLevels copied;
};
using OverviewChildren = std::vector<std::shared_ptr<const OverviewChild>>;

/// Returns the name and version of this program. Every shard that it writes stores this string.
std::string generator();

/// Returns the size of the child's arrays in bytes.
std::uint64_t bytes_of(const OverviewChild& child);

/// Reads only the levels that `overview` duplicates, and the downsample state from which the own levels of `overview`
/// are made.
/// Errors  InputError if the shard is damaged, has no downsample state, or its finest level is coarser than
///         overview.first_lod.
OverviewChild read_child(const ShardReader& reader, const CellJob& overview);

/// Returns the data that read_child() reads, but from a shard in memory. `begin` is the finest lattice level that the
/// overview duplicates (CellJob::kept_lod).
/// Exact   The result is equal to the result of read_child() on a file with this shard.
OverviewChild child_of(Shard&& shard, std::uint32_t begin);
OverviewChild child_of(const PackedShard& shard, std::uint32_t begin);

/// A function that returns the cached data of the child shard with this file name; null if it is not cached.
using FindChild = std::function<std::shared_ptr<const OverviewChild>(const std::string& file)>;

/// Returns all children of an overview. Reads a child from its shard in `out` if `find` returns null or data that begin
/// at another level. Several shards are read concurrently. Claims twice the children's bytes from memory_limit(),
/// because the overview holds a second copy of the duplicated levels.
/// Errors  The errors of read_child(). InputError: a file's fingerprint does not match its name, or the memory limit is
///         exceeded.
OverviewChildren read_children(const std::filesystem::path& out, const CellJob& overview, const FindChild& find,
                               const ThreadPool& pool);

/// Makes the overview's volume from its children.
/// Exact   The result depends only on the job, the children's shards and the parameters; its bits are equal for every
///         caller and number of threads.
/// Errors  InputError if the children contradict each other or the parameters.
kernels::CellVolume make_overview(const CellJob& overview, const OverviewChildren& children,
                                  const BakeParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
