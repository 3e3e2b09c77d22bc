/// The folder of a sample, replaced as a whole: written aside in it, then renamed into place.
#pragma once

#include <filesystem>

namespace gigabake::sample {

/// Unless publish() succeeds, the destructor removes what was written.
class SampleFolder {
 public:
  /// Errors  InputError where `dir` holds anything but a sample, or cannot be written.
  explicit SampleFolder(const std::filesystem::path& dir);
  ~SampleFolder();
  SampleFolder(const SampleFolder&) = delete;
  SampleFolder& operator=(const SampleFolder&) = delete;

  /// Where to write tileset.json, tiles/ and local/; both folders exist, and each has nothing but an empty textures/.
  const std::filesystem::path& aside() const { return aside_; }

  /// The former sample goes, tile for tile; the new one takes its place, tileset.json last. Errors  InputError.
  void publish();

 private:
  void discard();

  std::filesystem::path dir_, aside_;
  bool made_dir_ = false;
};

/// The first lines of a sample's tileset.json hold it, and so it tells one's own folder from another's.
inline constexpr char sample_generator[] = "gigabake sample";

}  // namespace gigabake::sample
