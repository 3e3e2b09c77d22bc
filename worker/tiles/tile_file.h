/// A large tile on scratch: clusters of its meshes, and images. A cell reads only the clusters and images that it
/// needs.
///
/// The file is the concatenated bytes of clusters and images, then a directory, then a trailer. The layout is private
/// to one version of the program (tile_file_version). A file of another version, or a truncated one, counts as missing.
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

/// Version of the file. Increment it when the same tile would be read or stored differently.
inline constexpr std::uint32_t tile_file_version = 8;

/// Location of a cluster or an image in the file.
struct ScratchBytes {
  std::uint64_t offset = 0, checksum = 0, bytes = 0;
};

/// Appends the lists of a cluster to `bytes`; the returned offset counts from the beginning of `bytes`.
/// Range   The cluster has at most 65,536 vertices.
ScratchBytes append_cluster(const Primitive& cluster, std::vector<std::uint8_t>& bytes);

/// Writer of a tile's scratch file.
/// Errors  The errors of ScratchPublication.
class TileFileWriter {
 public:
  explicit TileFileWriter(std::filesystem::path target) : file_(std::move(target)) {}
  /// Appends bytes that TileFile::read() later reads in one call.
  ScratchBytes store(std::span<const std::uint8_t> bytes);
  /// Appends the concatenated results of append_cluster(); returns their offset in the file.
  std::uint64_t append_clusters(std::span<const std::uint8_t> bytes) { return file_.append(bytes); }
  void publish(std::span<const std::uint8_t> directory);

 private:
  ScratchPublication file_;
};

class TileFile {
 public:
  /// Opens a tile's scratch file; returns null if there is no complete file of this version.
  static std::shared_ptr<const TileFile> open(const std::filesystem::path& path);

  const std::vector<std::uint8_t>& directory() const { return directory_; }
  /// Reads the bytes and verifies their checksum. Thread-safe.
  /// Errors  IoError: the file cannot be read, or its checksum does not match. On a mismatch the file is removed, so
  ///         that the next attempt makes it again.
  std::vector<std::uint8_t> read(const ScratchBytes& stored) const;
  /// Reads the lists of one cluster.
  /// Errors  The errors of read().
  Primitive read_cluster(const ScratchBytes& cluster) const;

 private:
  [[noreturn]] void fail_other_bytes(const ScratchBytes& stored) const;

  std::filesystem::path path_;
  Descriptor file_;
  std::vector<std::uint8_t> directory_;
};

}  // namespace gigabake
