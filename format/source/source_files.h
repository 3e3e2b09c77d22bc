/// Where the files of a source are: in a folder, or in an archive that stands for one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "format/source/source_bytes.h"
#include "format/source/tiles/archive.h"
#include "format/system/file_stamp.h"

namespace gigabake {

/// A file in an archive has the path that it would have if the archive were a folder: "set.3tz/tileset.json".
class SourceFiles {
 public:
  explicit SourceFiles(std::filesystem::path folder) : root_(std::move(folder)) {}
  explicit SourceFiles(std::shared_ptr<const Archive> archive) : root_(archive->file()), archive_(std::move(archive)) {}

  /// The folder, or the archive: what bounds every URI.
  const std::filesystem::path& root() const { return root_; }
  const std::shared_ptr<const Archive>& archive() const { return archive_; }

  bool has(const std::filesystem::path& file) const;
  /// 0 where there is none.
  std::uint64_t size_of(const std::filesystem::path& file) const;
  /// Errors  InputError: no such file, larger than 4 GiB, cannot be read.
  std::vector<std::uint8_t> read(const std::filesystem::path& file) const;
  /// As read(), of what servers may keep packed by gzip: tiles, tilesets and subtrees.
  /// Errors  also as unpacked_gzip(), and where it unpacks to more than 4 GiB.
  std::vector<std::uint8_t> read_content(const std::filesystem::path& file) const;
  /// What read() reads, not read yet where that is in a folder, and then of any length. Errors  as read().
  SourceBytes open(const std::filesystem::path& file) const;
  /// What read_content() reads. A GLB in a folder is not read yet: every other kind is taken apart in memory.
  SourceBytes open_content(const std::filesystem::path& file) const;
  /// As read(), of what others refer to: buffers and images. Unpacked where it is a whole gzip file whose checksum is
  /// right; what only begins like one is taken as it is.
  std::vector<std::uint8_t> read_referenced(const std::filesystem::path& file) const;
  /// The first bytes of read_content(), at most `most_bytes`; nothing where there is no file.
  std::vector<std::uint8_t> content_head(const std::filesystem::path& file, std::size_t most_bytes) const;
  /// Of the file, known as `name`; of the archive, by its absolute path, where there is one.
  StampedFile stamp(const std::string& name, const std::filesystem::path& file) const;

 private:
  std::filesystem::path root_;
  std::shared_ptr<const Archive> archive_;
};

}  // namespace gigabake
