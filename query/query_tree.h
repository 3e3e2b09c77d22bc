/// First-hit tree (query/first_hit/first_hit.h) of one level of one shard.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/scene/paged_scene.h"
#include "format/shard/shard_reader.h"
#include "query/first_hit/shard_tree.h"
#include "query/first_hit_scene.h"

namespace gigabake {

/// An open shard, and the memory that the tree of one of its levels requires.
class QueryTreeSource {
 public:
  /// Opens the shard for level `lod` of the lattice, which the shard must store.
  /// Errors  InputError: no such file, not a shard, not the shard that the scene lists, damaged nodes.
  QueryTreeSource(const PagedScene& scene, const SceneCell& shard, int lod);

  /// Returns the memory required while the tree is built; the finished tree is smaller.
  std::uint64_t bytes_to_build() const;

 private:
  friend class QueryTree;
  std::filesystem::path path_;
  SceneCell shard_;
  int shard_lod_;
  ShardReader reader_;
  NodeTable nodes_;
  LeafShape leaf_shape_;
  std::uint64_t stored_voxels_ = 0, bricks_ = 0, constants_ = 0, leaf_octants_ = 0;
};

class QueryTree {
 public:
  /// Builds the tree.
  /// Errors  InputError: a damaged level; columns of different lengths.
  explicit QueryTree(const QueryTreeSource& source);

  std::uint64_t bytes() const { return scene_.bytes(); }
  /// Returns the tree in the form that rays traverse. The result borrows from this object.
  const kernels::ShardTree& view() const { return view_; }

 private:
  FirstHitScene scene_;  ///< coordinates as in query/first_hit/shard_tree.h
  kernels::ShardTree view_;
};

}  // namespace gigabake
