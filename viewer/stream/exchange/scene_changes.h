/// The difference between a scene and the scene that replaces it. Viewers keep equal shards.
#pragma once

#include <optional>
#include <vector>

#include "core/math/box3.h"
#include "format/scene/paged_scene.h"
#include "viewer/stream/exchange/edited_boxes.h"
#include "viewer/stream/exchange/paged_shards.h"
#include "viewer/stream/exchange/shard_table.h"

namespace gigabake {

struct SceneChanges {
  ShardNumbers numbers;        ///< of the next scene; equal shards keep their numbers
  std::vector<Box3i64> boxes;  ///< in which voxels of some level differ; lod-0 voxels
};

/// Returns whether one pool can contain both scenes. They then have the same lattice, place, channels, cell size and
/// overview levels, and both have pages or none.
bool are_exchangeable(const PagedScene& a, const PagedScene& b);

/// Compares the scenes by the content hashes of their shards. Adds the other shards of `next` to the table, and
/// replaces files of equal content. `edits` are the edits between the scenes: a cell that only they change counts as
/// the boxes of these edits.
/// Range   are_exchangeable(previous, next); `numbers` are the numbers of the shards of `previous` in `table`.
/// Exact   A voxel of an overview depends only on the voxels below it, except if the bake has `max_error`. An overview
///         with `max_error`, or without a changed cell below it, is a changed box.
SceneChanges changes_between(const PagedScene& previous, const ShardNumbers& numbers, const PagedScene& next,
                             const EditedBoxes& edits, ShardTable& table);

/// The max number of changed shards of scenes with pages that are exchanged in place.
inline constexpr std::size_t max_changed_shards = 4096;

/// Compares scenes with pages: pages with equal checksums are equal; others are read. Returns nullopt if the scenes
/// list other places of cells or overviews, have other parameters, or differ in more than max_changed_shards shards.
/// Also if a page cannot be read: the pages of a scene exist until the second publication after it.
/// Range   are_exchangeable(previous, next); both have pages.
/// Exact   See changes_between().
std::optional<SceneChanges> paged_changes_between(const PagedScene& previous, const ShardNumbers& numbers,
                                                  const PagedScene& next, const EditedBoxes& edits,
                                                  PagedShards& shards);

}  // namespace gigabake
