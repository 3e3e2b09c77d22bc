/// The folder OUT of a bake, as rank 0 holds it: scene.xml and shards/.
#pragma once

#include <filesystem>
#include <vector>

#include "format/scene_xml.h"

namespace gigabake {

class OutputFolder {
 public:
  /// Makes OUT and OUT/shards where they are missing, and tries to write. What it made and nobody filled is removed
  /// with it.
  /// Errors  InputError: OUT is no folder, cannot be written, or lies in the folder of tiles that is baked.
  OutputFolder(std::filesystem::path out, const std::filesystem::path& source);
  /// Moves cells whose shard is not in OUT to the losses: a rank may have written to a disk of its own.
  void expect_shards(SceneDescription& scene) const;
  /// There is a scene.xml, and it misses nothing.
  bool has_whole_scene() const;
  /// Replaces scene.xml. Then shards of earlier bakes that it does not name are removed, and what killed writers left.
  /// Errors  InputError: scene.xml is as it was.
  void publish(const SceneDescription& scene) const;

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

  std::filesystem::path out_;
  NewFolders folders_;
};

/// On every rank, once rank 0 has made the folder. Errors  InputError: this host does not see it.
void expect_output_folder(const std::filesystem::path& out);

}  // namespace gigabake
