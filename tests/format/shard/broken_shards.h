/// Changes to made::small_shard(), each of which breaks one rule. Readers of whole shards and of parts must detect all.
#pragma once

#include <functional>
#include <vector>

#include "format/shard/shard.h"
#include "made_shard.h"

namespace gigabake::made {

struct BrokenShard {
  const char* rule;  ///< text in the reader's message
  std::function<void(Shard&)> spoil;
};

inline std::vector<BrokenShard> broken_shards() {
  return {
      {"lods does not match", [](Shard& s) { s.header.lods = 3; }},
      {"columns differ in length", [](Shard& s) { s.nodes.value.pop_back(); }},
      {"the node's type is unknown", [](Shard& s) { s.nodes.kind[2] = NodeKind(3); }},
      {"first_child is out of order", [](Shard& s) { s.nodes.first_child[0] = 2; }},
      {"has more children than there are rows", [](Shard& s) { s.nodes.child_mask[0] = 0xff; }},
      {"has no parent", [](Shard& s) { s.nodes.child_mask[0] = 1; }},
      {"value is not the next brick of its level", [](Shard& s) { s.nodes.value[1] = 7; }},
      {"number of bricks differs", [](Shard& s) { s.nodes.kind[1] = NodeKind::constant; }},
      {"a voxel without coverage", [](Shard& s) { s.levels[0].rgba[3] = 0; }},
      {"/lod_1: row 1: plane is neither",
       [](Shard& s) { s = small_shard_with_planes(), s.levels[1].directional_coverage[7] = 0x3c; }},
      {"/lod_1: row 0: plane is neither",
       [](Shard& s) { s = small_shard_with_planes(), s.levels[1].directional_coverage[3] = 0x43; }},
      {"/lod_0: row 2: plane is neither",
       [](Shard& s) { s = small_shard_with_planes(), s.levels[0].directional_coverage[11] = 0x43; }},
      {"/nodes: row 2: plane is neither",
       [](Shard& s) { s = small_shard_with_planes(), s.nodes.directional_coverage[2][3] = 3; }},
  };
}

}  // namespace gigabake::made
