/// The folder OUT of a bake, as rank 0 holds it: scene.xml, shards/ and what speeds up the next bake.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "cluster/folder_lock.h"
#include "format/scene/scene_xml.h"

namespace gigabake {

/// Shards that no cell of the scene has: of earlier parameters, tiles or textures. Going back to these costs nothing as
/// long as they are kept.
struct OrphanShards {
  std::size_t files = 0;
  std::uint64_t bytes = 0;
};

class OutputFolder {
 public:
  /// Makes OUT and OUT/shards where they are missing, locks OUT, removes what killed writers left, and tries to write.
  /// What it made and nobody filled is removed with it. The lock is held for the object's life.
  /// Errors  InputError: OUT is no folder, cannot be written, lies in the folder of tiles that is baked, or another
  /// bake
  ///         holds it: its files are as they were.
  OutputFolder(std::filesystem::path out, const std::filesystem::path& source);
  /// Moves cells whose shard is not in OUT to the losses: a rank may have written to a disk of its own.
  void expect_shards(SceneDescription& scene) const;
  /// There is a scene.xml, and it misses nothing.
  bool has_whole_scene() const;
  /// Replaces scene.xml; pages of the scene before and what killed writers left are removed. Errors  InputError:
  /// scene.xml is as it was.
  void publish(const SceneDescription& scene) const;
  OrphanShards orphans(const SceneDescription& scene) const;
  /// Once `scene` is published and misses nothing: shards of cells that it misses may be whole and of use to the next
  /// bake. The answer is what is gone.
  OrphanShards remove_orphans(const SceneDescription& scene) const;

  std::filesystem::path journal() const { return out_ / "journal"; }

 private:
  /// Folders that were made here; the empty ones go with it.
  class NewFolders {
   public:
    NewFolders() = default;
    ~NewFolders();
    NewFolders(const NewFolders&) = delete;
    NewFolders& operator=(const NewFolders&) = delete;
    void make(const std::filesystem::path& folder);

   private:
    std::vector<std::filesystem::path> made_;
  };

  void remove_leftovers() const;

  std::filesystem::path out_;
  NewFolders folders_;
  std::optional<FolderLock> lock_;
};

/// Where a bake into `out` keeps its surveys for the next one.
inline std::filesystem::path survey_cache_of(const std::filesystem::path& out) { return out / "survey.cache"; }

/// On every rank, once rank 0 has made the folder. Errors  InputError: this host does not see it.
void expect_output_folder(const std::filesystem::path& out);

}  // namespace gigabake
