/// A .3tz archive: a ZIP file that stands for the folder of a tileset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gigabake {

/// Thread-safe. Its list of entries is read once; the index that 3tz adds for readers over a network is not needed.
class Archive {
 public:
  /// Errors  InputError: no ZIP file, or one that is damaged; gigabake was built without libzip.
  explicit Archive(const std::filesystem::path& file);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  const std::filesystem::path& file() const { return file_; }

  /// Uncompressed bytes of an entry, named as "folder/file"; nothing where there is none.
  std::optional<std::uint64_t> size_of(const std::string& entry) const;

  /// The first bytes of an entry, at most `most_bytes`.
  /// Errors  InputError: there is no such entry, its bytes do not have the checksum or the number that the archive
  ///         says, they are encrypted or compressed by a method that libzip does not know.
  std::vector<std::uint8_t> read(const std::string& entry, std::uint64_t most_bytes) const;

 private:
  struct State;
  std::filesystem::path file_;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
