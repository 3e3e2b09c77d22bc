/// The first rows of a node table (its coarsest levels), read without the remaining rows.
#pragma once

#include "format/shard/columns/stored_rows.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Returns the rows of levels [begin, lods).
/// Range   begin < header.lods.
/// Cost    Reads these rows of `kind` and `child_mask` and up to a few thousand rows after them. Reads value, normal
///         and directional coverage from the first to the last constant node.
/// Errors  InputError naming file, dataset, row and rule.
NodeTable read_coarse_nodes(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int begin);

}  // namespace gigabake
