/// A .3tz archive: a ZIP file that replaces the folder of a tileset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gigabake {

/// A thread-safe archive. Its entries are listed once. The index that 3tz adds for reading over a network is not used.
class Archive {
 public:
  /// Errors  InputError: the file is damaged or is not a ZIP file, or gigabake was built without libzip.
  explicit Archive(const std::filesystem::path& file);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  const std::filesystem::path& file() const { return file_; }

  /// Returns the uncompressed bytes of an entry, named as "folder/file"; nullopt if there is no such entry.
  std::optional<std::uint64_t> size_of(const std::string& entry) const;

  /// Returns the first bytes of an entry, at most `max_bytes`.
  /// Errors  InputError: the entry does not exist, is encrypted, or uses a compression method that libzip does not
  ///         support. Also if its checksum or length differs from the values in the archive.
  std::vector<std::uint8_t> read(const std::string& entry, std::uint64_t max_bytes) const;

 private:
  struct State;
  std::filesystem::path file_;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
