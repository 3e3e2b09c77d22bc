/// An overview (parent) made of its children's shards, by whoever bakes it and by whoever verifies it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "format/shard/packed_shard.h"
#include "kernels/body/cell.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/copied_levels.h"

namespace gigabake {

/// What an overview needs of a child's shard.
struct ChildOfParent {
  ParentSource source;
  ChildLevels copied;
};
using ChildrenOfParent = std::vector<std::shared_ptr<const ChildOfParent>>;

/// What shards that this program writes say of who wrote them.
std::string generator();

/// Returns the bytes of its arrays.
std::uint64_t bytes_of(const ChildOfParent& child);

/// Reads only the rows that `parent` copies, and what its own levels are made of.
/// Errors  InputError: damaged; a shard that keeps nothing for parents, or lacks a level that the parent copies.
ChildOfParent read_child(const ShardReader& reader, const CellJob& parent);

/// The same of a shard in memory. begin: the first level of the lattice that an overview copies (CellJob::kept_lod).
/// Exact   What read_child() reads of the file with this shard.
ChildOfParent child_of(Shard&& shard, std::uint32_t begin);
ChildOfParent child_of(const PackedShard& shard, std::uint32_t begin);

/// Returns what is in memory of a child's shard, by its file's name; null where nothing is.
using FindChild = std::function<std::shared_ptr<const ChildOfParent>(const std::string& file)>;

/// Returns all of a parent's children; reads those that `find` does not return from OUT, several concurrently. Twice
/// their bytes are compared with memory_limit(): the parent's own levels have the voxels of their copies.
/// Errors  InputError: as read_child(), a file that is not the one of its name, or more memory than allowed.
ChildrenOfParent read_children(const std::filesystem::path& out, const CellJob& parent, const FindChild& find,
                               const ThreadPool& pool);

/// Exact   A function of the children's shards: the same bits for every caller and number of threads.
/// Errors  InputError: children that contradict each other or the parameters.
kernels::CellVolume make_parent(const CellJob& parent, const ChildrenOfParent& children,
                                const BakeParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
