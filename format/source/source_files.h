/// Files of a source, in a folder or in an archive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "format/source/content/source_bytes.h"
#include "format/source/tiles/archive.h"
#include "format/system/file_stamp.h"

namespace gigabake {

/// Files of a folder or an archive. A file in an archive has a path as if the archive were a folder:
/// "set.3tz/tileset.json".
class SourceFiles {
 public:
  explicit SourceFiles(std::filesystem::path folder) : root_(std::move(folder)) {}
  explicit SourceFiles(std::shared_ptr<const Archive> archive) : root_(archive->file()), archive_(std::move(archive)) {}

  /// Returns the folder or the archive; no URI may leave it.
  const std::filesystem::path& root() const { return root_; }
  const std::shared_ptr<const Archive>& archive() const { return archive_; }

  bool has(const std::filesystem::path& file) const;
  /// Returns 0 if there is no such file.
  std::uint64_t size_of(const std::filesystem::path& file) const;
  /// Errors  InputError: no such file, larger than 4 GiB, cannot be read.
  std::vector<std::uint8_t> read(const std::filesystem::path& file) const;
  /// Reads a tile, tileset or subtree, which may be gzip-compressed.
  /// Errors  InputError like read() and unpacked_gzip(). Unpacked content must not exceed 4 GiB or memory_limit().
  std::vector<std::uint8_t> read_content(const std::filesystem::path& file) const;
  /// Returns the bytes that read() would read. A file in a folder is not read yet, and may have any length.
  /// Errors  InputError like read().
  SourceBytes open(const std::filesystem::path& file) const;
  /// Returns the bytes that read_content() would read. A GLB in a folder is not read yet; all other content is read
  /// into memory.
  SourceBytes open_content(const std::filesystem::path& file) const;
  /// Reads a buffer or an image that another file refers to. Unpacks it if it is a whole gzip file with a correct
  /// checksum; otherwise returns the bytes unchanged.
  std::vector<std::uint8_t> read_referenced(const std::filesystem::path& file) const;
  /// Returns the first bytes of read_content(), at most `max_bytes`; empty if there is no file.
  std::vector<std::uint8_t> content_head(const std::filesystem::path& file, std::size_t max_bytes) const;
  /// Returns the stamp of a file, with `name` as its name. For a file in an archive, returns the stamp and the absolute
  /// path of the archive.
  StampedFile stamp(const std::string& name, const std::filesystem::path& file) const;

 private:
  std::filesystem::path root_;
  std::shared_ptr<const Archive> archive_;
};

}  // namespace gigabake
