/// A .3tz archive: a ZIP file that replaces the folder of a tileset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gigabake {

/// A thread-safe archive. Its entries are listed once; the index that 3tz adds for reading over a network is not
/// needed.
class Archive {
 public:
  /// Errors  InputError: no ZIP file, or one that is damaged; gigabake was built without libzip.
  explicit Archive(const std::filesystem::path& file);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  const std::filesystem::path& file() const { return file_; }

  /// Returns the uncompressed bytes of an entry, named as "folder/file"; nullopt if there is no such entry.
  std::optional<std::uint64_t> size_of(const std::string& entry) const;

  /// Returns the first bytes of an entry, at most `max_bytes`.
  /// Errors  InputError: no such entry; another checksum or length than the archive states; encrypted; compressed by a
  ///         method that libzip does not support.
  std::vector<std::uint8_t> read(const std::string& entry, std::uint64_t max_bytes) const;

 private:
  struct State;
  std::filesystem::path file_;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
