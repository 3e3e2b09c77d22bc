/// A parent made of its children's shards: by who bakes it, and by who checks that it is what its children make.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "kernels/body/cell.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/copied_levels.h"

namespace gigabake {

/// What a parent needs of a child's shard.
struct ChildOfParent {
  ParentSource source;
  ChildLevels copied;
};

/// What shards that this program writes say of who wrote them.
std::string generator();

/// Of its arrays.
std::uint64_t bytes_of(const ChildOfParent& child);

/// Errors  InputError: damaged; a shard that keeps nothing for parents, or lacks a level that the parent copies.
ChildOfParent read_child(const ShardReader& reader, const CellJob& parent);

/// All of a parent's children, of which OUT has the files. Twice their bytes are held against memory_limit(): beside
/// them stand the parent's own levels, which have the voxels of their copies.
/// Errors  InputError: as above, a file that is not the one of its name, or more memory than allowed.
std::vector<ChildOfParent> read_children(const std::filesystem::path& out, const CellJob& parent);

/// Exact   A function of the children's shards: the same bits whoever makes it, on whichever threads.
/// Errors  InputError: children that contradict each other or the parameters.
kernels::CellVolume make_parent(const CellJob& parent, const std::vector<ChildOfParent>& children,
                                const BakeParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
