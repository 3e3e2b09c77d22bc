/// The output folder OUT of a bake: scene.xml, shards/ and caches for the next bake. Only rank 0 has this object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "cluster/process/folder_lock.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Shards that no cell of the scene uses; they come from earlier parameters, tiles or textures. While they are kept, a
/// bake with these earlier inputs reuses them.
struct OrphanShards {
  std::size_t files = 0;
  std::uint64_t bytes = 0;
};

/// Returns the journal of the bakes into `out`.
inline std::filesystem::path journal_of(const std::filesystem::path& out) { return out / "journal"; }

/// Returns the plan of the running bake into `out` (scheduler/journal/plan_record.h).
inline std::filesystem::path plan_file_of(const std::filesystem::path& out) { return out / "plan"; }

class OutputFolder {
 public:
  /// Creates OUT and OUT/shards if they are missing, locks OUT, removes temporary files of killed writers, and tests
  /// writing. The object keeps the lock until it is destroyed. Its destructor again removes temporary files of killed
  /// writers, and the folders that the object created if they are still empty.
  /// Errors  InputError: OUT is not a folder, cannot be written, or lies in the source folder, or another bake has
  ///         locked it. The files in OUT are then unchanged.
  OutputFolder(std::filesystem::path out, const std::filesystem::path& source);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  /// Moves the cells and overviews whose shard is not in OUT to the losses. A rank may have written the shard to a
  /// local disk.
  void expect_shards(SceneDescription& scene) const;
  /// Returns true if scene.xml exists and records no losses.
  bool has_whole_scene() const;
  /// Replaces scene.xml; removes pages of the previous scene and temporary files of killed writers.
  /// Errors  InputError: scene.xml is unchanged.
  void publish(const SceneDescription& scene) const;
  OrphanShards orphans(const SceneDescription& scene) const;
  /// Removes the unreferenced shards, and returns their number and size. Call it only after `scene` is published
  /// without losses: shards of missing cells may be valid and useful to the next bake.
  OrphanShards remove_orphans(const SceneDescription& scene) const;

  std::filesystem::path journal() const { return journal_of(out_); }

 private:
  /// The folders that this object created. Its destructor removes those that are empty.
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

  void remove_temporary_files() const;

  std::filesystem::path out_;
  NewFolders folders_;
  std::optional<FolderLock> lock_;
};

/// Returns the file in which a bake into `out` keeps its scan results for the next bake.
inline std::filesystem::path scan_cache_of(const std::filesystem::path& out) { return out / "survey.cache"; }

/// Checks that this rank's host sees the output folder. Call it on every rank after rank 0 has created the folder.
/// Errors  InputError: this host does not see the folder.
void expect_output_folder(const std::filesystem::path& out);

}  // namespace gigabake
