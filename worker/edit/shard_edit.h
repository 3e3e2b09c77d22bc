/// The shard of a cell from a stored shard of the same cell to which some of its edits were not applied yet. It needs
/// no source.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "format/shard/levels/level_summary.h"
#include "format/shard/splice/spliced_shard.h"
#include "worker/edit/cell_edits.h"

namespace gigabake {

/// The result of an edit of a stored shard.
struct EditedShard {
  SplicedShard shard;                   ///< its header has the content hash; the caller sets the fingerprint
  std::vector<std::uint64_t> voxels;    ///< per lod; constant nodes count as the voxels that they represent
  std::vector<LevelSummary> summaries;  ///< per lod, without stored sizes
  std::uint64_t bricks = 0;             ///< bricks that were built again, of all levels

  bool empty() const { return shard.nodes.key.empty(); }
};

/// Applies edits to a stored shard.
/// Exact   Equals a bake of the cell with all edits, in every bit.
/// Range   The shard has the parameters `parameters`, with max_error 0, and base.is_spliceable(). `edits` omits the
///         edits that the shard has already.
/// Cost    Reads which voxels exist, and the voxels below each changed voxel of the coarsest level. Builds the bricks
///         that the edits change, and their ancestors. nullopt if more than a quarter of a large cell had to be read,
///         because a bake then takes about the same time, with less memory.
/// Errors  InputError: the shard is damaged.
std::optional<EditedShard> edited_shard(const BaseShard& base, const CellEdits& edits,
                                        const kernels::CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
