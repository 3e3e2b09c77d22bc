/// The folder of a sample. The sample is written to a temporary folder in it; publish() moves the files into place.
#pragma once

#include <filesystem>

namespace gigabake::sample {

/// The owner of a temporary folder. Unless publish() succeeds, the destructor removes the folder.
class SampleFolder {
 public:
  /// Errors  InputError if `dir` contains a sample or other content, or is not writable. Remains of a killed run are
  ///         allowed.
  explicit SampleFolder(const std::filesystem::path& dir);
  ~SampleFolder();
  SampleFolder(const SampleFolder&) = delete;
  SampleFolder& operator=(const SampleFolder&) = delete;

  /// Returns the folder for tileset.json, tiles/ and local/. Both subfolders exist and contain only an empty textures/.
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Removes remains of a killed run, and renames the new files into their final place, tileset.json last.
  /// Errors  InputError.
  void publish();

 private:
  void discard();

  std::filesystem::path dir_, temporary_;
  bool made_dir_ = false;
};

/// Generator name in the first lines of a sample's tileset.json, which identifies a folder as a sample.
inline constexpr char sample_generator[] = "gigabake sample";

}  // namespace gigabake::sample
