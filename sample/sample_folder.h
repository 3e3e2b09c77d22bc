/// The folder of a sample, replaced completely: written to a temporary folder in it, then renamed.
#pragma once

#include <filesystem>

namespace gigabake::sample {

/// Owns a temporary folder. Unless publish() succeeds, the destructor removes it.
class SampleFolder {
 public:
  /// Errors  InputError if `dir` contains anything but a sample, or is not writable.
  explicit SampleFolder(const std::filesystem::path& dir);
  ~SampleFolder();
  SampleFolder(const SampleFolder&) = delete;
  SampleFolder& operator=(const SampleFolder&) = delete;

  /// Returns the folder for tileset.json, tiles/ and local/. Both subfolders exist and contain only an empty textures/.
  const std::filesystem::path& aside() const { return aside_; }

  /// Removes the previous sample and renames the new one into its place, tileset.json last.
  /// Errors  InputError.
  void publish();

 private:
  void discard();

  std::filesystem::path dir_, aside_;
  bool made_dir_ = false;
};

/// Generator name in the first lines of a sample's tileset.json, which identifies a folder as a sample.
inline constexpr char sample_generator[] = "gigabake sample";

}  // namespace gigabake::sample
