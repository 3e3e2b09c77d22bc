#include "format/shard/check/shard_outline.h"

namespace gigabake {

ShardOutline::ShardOutline(const std::filesystem::path& path, const ShardHeader& header,
                           const std::vector<std::uint8_t>& lod, const std::vector<NodeKind>& kind,
                           const std::vector<std::uint8_t>& child_mask)
    : rows_(lod.size()), bricks_(header.lods, 0) {
  BrokenRule{path, "/nodes"}.expect(kind.size() == rows_ && child_mask.size() == rows_, 0, "columns differ in length");
  NodeWalk walk(path, header, rows_);
  for (std::uint64_t i = 0; i < rows_; ++i) {
    if (i % rows_per_place == 0) places_.push_back(walk.place());
    walk.step(lod[i], kind[i], child_mask[i]);
    if (kind[i] == NodeKind::brick) ++bricks_[lod[i]];
  }
}

}  // namespace gigabake
