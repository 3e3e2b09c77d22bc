/// The invariants of a shard: everything a reader may rely on without looking.
#pragma once

#include <filesystem>

#include "format/shard.h"

namespace gigabake {

/// Errors (all)  InputError naming `path`, the dataset and the first row that breaks a rule.
void check_header(const std::filesystem::path& path, const ShardHeader& header);
/// Level by level from the root, Morton order, every child linked from exactly one parent, values in range.
void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& nodes);
/// Arrays agree in length, `first` counts the mask's bits, alpha is never 0.
void check_level(const std::filesystem::path& path, const ShardHeader& header, const BrickLevel& level, int lod);
/// Bricks of every level are used by exactly one node each, in order.
void check_bricks_in_use(const std::filesystem::path& path, const Shard& shard);

}  // namespace gigabake
