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

/// Returns the name and version of this program, which the shards that it writes store.
std::string generator();

/// Returns the bytes of the child's arrays.
std::uint64_t bytes_of(const OverviewChild& child);

/// Reads only the levels that `overview` duplicates and the downsample state that its own levels are made from.
/// Errors  InputError: damaged; a shard without downsample state, or without a level that the overview duplicates.
OverviewChild read_child(const ShardReader& reader, const CellJob& overview);

/// Returns the same data from a shard in memory. begin: the first lattice level that an overview duplicates
/// (CellJob::kept_lod).
/// Exact   Equal to the result of read_child() on a file with this shard.
OverviewChild child_of(Shard&& shard, std::uint32_t begin);
OverviewChild child_of(const PackedShard& shard, std::uint32_t begin);

/// Returns the in-memory data of a child's shard, by its file name; null if there is none.
using FindChild = std::function<std::shared_ptr<const OverviewChild>(const std::string& file)>;

/// Returns all children of an overview. Reads the children that `find` does not return from OUT, several concurrently.
/// Claims twice their bytes from memory_limit(), because the overview's own copy of duplicated levels has as many
/// voxels.
/// Errors  The errors of read_child(). InputError: a file's fingerprint does not match its name, or the memory limit is
///         exceeded.
OverviewChildren read_children(const std::filesystem::path& out, const CellJob& overview, const FindChild& find,
                               const ThreadPool& pool);

/// Makes the overview.
/// Exact   A function of the children's shards: the same bits for every caller and number of threads.
/// Errors  InputError: children that contradict each other or the parameters.
kernels::CellVolume make_overview(const CellJob& overview, const OverviewChildren& children,
                                  const BakeParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
