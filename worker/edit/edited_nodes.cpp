#include "worker/edit/edited_nodes.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>

#include "kernels/cpu/prune/prune.h"
#include "worker/edit/level_bricks.h"

namespace gigabake {
namespace {

using kernels::CommonVoxel;

/// The nodes of the edited bricks of one level that have voxels. Nodes below a leaf-constant node are included.
using NodesOfLevel = std::vector<EditedNode>;

const EditedNode* find_in(const NodesOfLevel& nodes, std::uint64_t key) {
  const auto at = std::ranges::lower_bound(nodes, key, {}, &EditedNode::key);
  return at != nodes.end() && at->key == key ? &*at : nullptr;
}

bool is_edited(const EditedLevel& level, std::uint64_t key) {
  return std::binary_search(level.keys.begin(), level.keys.end(), key);
}

/// Classifies the edited bricks, from the finest level.
class EditedClasses {
 public:
  EditedClasses(const StoredBricks& stored, const std::vector<EditedLevel>& edited)
      : stored_(stored), edited_(edited), nodes_(edited.size()) {
    for (std::size_t lod = 0; lod < edited.size(); ++lod)
      for (std::size_t b = 0; b < edited[lod].after.key.size(); ++b) nodes_[lod].push_back(classified(lod, b));
  }

  const NodesOfLevel& level(std::size_t lod) const { return nodes_[lod]; }

  /// Returns the node of a brick after the edits; nullopt if it has no voxels.
  std::optional<StoredNode> node(std::size_t lod, std::uint64_t key) const {
    if (!is_edited(edited_[lod], key)) return stored_.node(int(lod), key);
    const EditedNode* found = find_in(nodes_[lod], key);
    return found != nullptr ? std::optional(found->node) : std::nullopt;
  }

 private:
  EditedNode classified(std::size_t lod, std::size_t brick) const {
    const kernels::Level& level = edited_[lod].after;
    const std::optional<CommonVoxel> value = kernels::common_value(level, brick);
    StoredNode node{kernels::kind_of_brick(value.has_value()), value.value_or(CommonVoxel{})};
    if (value) node.kind = kernels::kind_of_constant(lod == 0 || is_like_all_below(lod, level.key[brick], *value));
    return {level.key[brick], node, no_stored_brick};
  }

  bool is_like_all_below(std::size_t lod, std::uint64_t key, const CommonVoxel& value) const {
    for (std::uint64_t child = 8 * key; child < 8 * key + 8; ++child) {
      const std::optional<StoredNode> below = node(lod - 1, child);
      if (!below || !kernels::ends_branch(below->kind) || !kernels::are_equal(below->value, value)) return false;
    }
    return true;
  }

  const StoredBricks& stored_;
  const std::vector<EditedLevel>& edited_;
  std::vector<NodesOfLevel> nodes_;
};

/// Returns the stored nodes of one level, by rising key.
NodesOfLevel stored_nodes(const BaseShard& base, const StoredBricks& stored, std::size_t lod) {
  NodesOfLevel out;
  const NodeTable& nodes = base.nodes();
  const auto of_level = std::ranges::equal_range(nodes.lod, std::uint8_t(lod), std::greater());
  const auto begin = std::size_t(of_level.begin() - nodes.lod.begin());
  out.reserve(of_level.size());
  for (std::size_t n = begin; n < begin + of_level.size(); ++n) {
    const bool is_brick = nodes.kind[n] == NodeKind::brick;
    out.push_back({nodes.key[n], is_brick ? StoredNode{} : *stored.node(int(lod), nodes.key[n]),
                   is_brick ? nodes.value[n] : no_stored_brick});
  }
  return out;
}

/// Removes the nodes without a parent, and the nodes whose parent ends the branch.
void remove_below_leaves(const NodesOfLevel& above, NodesOfLevel& nodes) {
  auto parent = above.begin();
  std::erase_if(nodes, [&](const EditedNode& node) {
    while (parent != above.end() && parent->key < node.key >> 3) ++parent;
    const bool has_parent = parent != above.end() && parent->key == node.key >> 3;
    return !has_parent || kernels::ends_branch(parent->node.kind);
  });
}

/// Appends the children that an edited brick has from a stored leaf-constant node, in the place of that node.
void add_children_of_leaf(const StoredBricks& stored, const EditedLevel& level, int lod, std::uint64_t parent,
                          NodesOfLevel& out) {
  const std::optional<StoredNode> before = stored.node(lod + 1, parent);
  if (!before || !kernels::ends_branch(before->kind)) return;
  for (std::uint64_t child = 8 * parent; child < 8 * parent + 8; ++child)
    if (!is_edited(level, child)) out.push_back({child, *before, no_stored_brick});
}

}  // namespace

const EditedNode* EditedNodes::find(std::size_t lod, std::uint64_t key) const { return find_in(levels[lod], key); }

EditedNodes edited_nodes(const BaseShard& base, const StoredBricks& stored, const std::vector<EditedLevel>& edited) {
  const EditedClasses classes(stored, edited);
  EditedNodes out;
  out.levels.resize(edited.size());
  for (std::size_t lod = edited.size(); lod-- > 0;) {
    NodesOfLevel kept = stored_nodes(base, stored, lod), added = classes.level(lod);
    std::erase_if(kept, [&](const EditedNode& node) { return is_edited(edited[lod], node.key); });
    if (lod + 1 < edited.size())
      for (const std::uint64_t parent : edited[lod + 1].keys)
        add_children_of_leaf(stored, edited[lod], int(lod), parent, added);
    std::ranges::sort(added, {}, &EditedNode::key);
    NodesOfLevel& nodes = out.levels[lod];
    nodes.reserve(kept.size() + added.size());
    std::ranges::merge(kept, added, std::back_inserter(nodes), {}, &EditedNode::key, &EditedNode::key);
    if (lod + 1 < edited.size()) remove_below_leaves(out.levels[lod + 1], nodes);
  }
  return out;
}

NodeTable EditedNodes::table(const ShardHeader& header) const {
  NodeTable nodes;
  std::size_t above = 0;
  for (std::size_t lod = levels.size(); lod-- > 0;) {
    const std::size_t begin = nodes.key.size();
    const bool has_coverage = header.has_directional_coverage && (lod > 0 || header.has_normals);
    std::uint32_t brick = 0;
    for (const EditedNode& node : levels[lod])
      kernels::append_node(node.key, lod, node.node.kind, node.node.value, has_coverage, header.has_classes, brick,
                           nodes);
    kernels::check_node_count(nodes.key.size());
    if (begin != 0) kernels::link_children(nodes, above, begin);
    above = begin;
  }
  nodes.has_finest_planes = header.has_directional_coverage && header.has_normals;
  if (!header.has_directional_coverage) nodes.directional_coverage.clear();
  return nodes;
}

}  // namespace gigabake
