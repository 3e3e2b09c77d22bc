/// A large tile on scratch: the clusters of its meshes and its images, each read by itself when a cell is near it.
///
/// Their bytes stand one behind the other, then a directory, then a trailer. Private to one version of the
/// program (tile_file_version): a file of another one, or one that is cut, counts as none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "format/source/mesh.h"
#include "format/system/descriptor.h"
#include "worker/tiles/scratch_publication.h"

namespace gigabake {

/// Raised whenever the same tile would be read or stored otherwise.
inline constexpr std::uint32_t tile_file_version = 1;

/// Where a cluster or an image is in the file.
struct ScratchBytes {
  std::uint64_t offset = 0, checksum = 0, bytes = 0;
};

/// Appends position, uv, rgba and index to `bytes`; the answer's offset counts from their begin.
/// Range  At most 65,536 vertices.
ScratchBytes append_cluster(const Primitive& cluster, std::vector<std::uint8_t>& bytes);

/// Errors  As ScratchPublication.
class TileFileWriter {
 public:
  explicit TileFileWriter(std::filesystem::path target) : file_(std::move(target)) {}
  /// Bytes that are read as one.
  ScratchBytes store(std::span<const std::uint8_t> bytes);
  /// Clusters of append_cluster(), one behind the other; the offset at which they stand.
  std::uint64_t append_clusters(std::span<const std::uint8_t> bytes) { return file_.append(bytes); }
  void publish(std::span<const std::uint8_t> directory);

 private:
  ScratchPublication file_;
};

class TileFile {
 public:
  /// Null where there is no whole file of this version.
  static std::shared_ptr<const TileFile> open(const std::filesystem::path& path);

  const std::vector<std::uint8_t>& directory() const { return directory_; }
  /// Several threads may read.
  /// Errors  IoError: it cannot be read, or does not hold what was written; the file is removed, so that another try
  ///         makes it anew.
  std::vector<std::uint8_t> read(const ScratchBytes& stored) const;
  /// position, uv, rgba and index of one cluster. Errors  As read().
  Primitive read_cluster(const ScratchBytes& cluster) const;

 private:
  [[noreturn]] void fail_other_bytes(const ScratchBytes& stored) const;

  std::filesystem::path path_;
  Descriptor file_;
  std::vector<std::uint8_t> directory_;
};

}  // namespace gigabake
