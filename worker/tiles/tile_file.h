/// A large tile on scratch: the clusters of its meshes, each read by itself when a cell is near it.
///
/// The clusters' bytes stand one behind the other, then a directory, then a trailer. Private to one version of the
/// program (tile_file_version): a file of another one, or one that is cut, counts as none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/system/descriptor.h"
#include "format/system/publish.h"

namespace gigabake {

/// Raised whenever the same tile would be read or stored otherwise.
inline constexpr std::uint32_t tile_file_version = 1;

/// Where a cluster is in the file.
struct StoredCluster {
  std::uint64_t offset = 0, checksum = 0;
  std::uint32_t bytes = 0;
};

/// Appends position, uv, rgba and index to `bytes`; the answer's offset counts from their begin.
/// Range  At most 65,536 vertices.
StoredCluster append_cluster(const Primitive& cluster, std::vector<std::uint8_t>& bytes);

/// Errors  IoError of every member: the file and the system's reason; what was written is gone.
class TileFileWriter {
 public:
  explicit TileFileWriter(std::filesystem::path target);
  /// The offset at which they stand.
  std::uint64_t append(std::span<const std::uint8_t> bytes);
  /// The file appears whole. Not flushed: after a loss of power it may be cut, and is made again.
  void publish(std::span<const std::uint8_t> directory);

 private:
  std::filesystem::path target_;
  Publication publication_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
};

class TileFile {
 public:
  /// Null where there is no whole file of this version.
  static std::shared_ptr<const TileFile> open(const std::filesystem::path& path);

  const std::vector<std::uint8_t>& directory() const { return directory_; }
  /// position, uv, rgba and index of one cluster. Several threads may read.
  /// Errors  IoError: it cannot be read, or does not hold what was written; the file is removed, so that another try
  ///         makes it anew.
  Primitive read(const StoredCluster& cluster) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::vector<std::uint8_t> directory_;
};

}  // namespace gigabake
