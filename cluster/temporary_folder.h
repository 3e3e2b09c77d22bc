/// A folder that goes again, with all that is in it.
#pragma once

#include <filesystem>

namespace gigabake {

class TemporaryFolder {
 public:
  /// in: where it is made; empty: among the system's temporary files.
  /// Errors  InputError: it cannot be made.
  explicit TemporaryFolder(const std::filesystem::path& in = {});
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace gigabake
