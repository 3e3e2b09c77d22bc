#include "worker/tiles/tile_file.h"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <system_error>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/base/error.h"
#include "core/base/work_counts.h"

namespace gigabake {
namespace {

constexpr std::uint64_t magic = 0x656c697462676267;  // "gbgbtile"

struct Trailer {
  std::uint64_t offset = 0, bytes = 0, checksum = 0;  ///< location of the directory
  std::uint64_t version = tile_file_version, mark = magic;
};

struct ClusterHead {
  std::uint32_t vertices = 0, corners = 0;
  std::uint32_t has_uv = 0, has_rgba = 0, has_normal = 0, has_normal_uv = 0, has_tangent = 0, has_id_uv = 0,
                shares_uv = 0;

  std::uint64_t bytes() const {
    const std::uint64_t vertex_bytes =
        12 + 8 * has_uv + 8 * has_rgba + 4 * has_normal + 8 * has_normal_uv + 4 * has_tangent + 8 * has_id_uv;
    return sizeof *this + vertices * vertex_bytes + 2 * std::uint64_t(corners);
  }
};

std::uint64_t checksum_of(std::span<const std::uint8_t> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

template <class T>
std::span<const std::uint8_t> raw_bytes(const T& value) {
  return {reinterpret_cast<const std::uint8_t*>(&value), sizeof value};
}

template <class T>
void append_values(const std::vector<T>& values, std::vector<std::uint8_t>& bytes) {
  const auto* from = reinterpret_cast<const std::uint8_t*>(values.data());
  bytes.insert(bytes.end(), from, from + values.size() * sizeof(T));
}

template <class T>
const std::uint8_t* take(const std::uint8_t* from, std::size_t count, std::vector<T>& values) {
  values.resize(count);
  if (count != 0) std::memcpy(values.data(), from, count * sizeof(T));
  return from + count * sizeof(T);
}

/// Returns false if the file ends early (errno is 0) or cannot be read (errno is set).
bool read_at(const Descriptor& file, std::uint64_t offset, std::span<std::uint8_t> bytes) {
  count_work(WorkCounter::file_bytes_read, bytes.size());
  errno = 0;
  while (!bytes.empty()) {
    const ssize_t got = ::pread(file.get(), bytes.data(), bytes.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes = bytes.subspan(std::size_t(got));
    offset += std::uint64_t(got);
  }
  return true;
}

std::uint64_t size_of(const Descriptor& file) {
  struct stat found {};
  return ::fstat(file.get(), &found) == 0 ? std::uint64_t(found.st_size) : 0;
}

}  // namespace

ScratchBytes append_cluster(const Primitive& cluster, std::vector<std::uint8_t>& bytes) {
  const std::size_t begin = bytes.size();
  const ClusterHead head{std::uint32_t(cluster.position.size() / 3),
                         std::uint32_t(cluster.index.size()),
                         cluster.uv.empty() ? 0u : 1u,
                         cluster.rgba.empty() ? 0u : 1u,
                         cluster.normal.empty() ? 0u : 1u,
                         cluster.normal_uv.empty() ? 0u : 1u,
                         cluster.tangent.empty() ? 0u : 1u,
                         cluster.id_uv.empty() ? 0u : 1u,
                         cluster.shares_uv ? 1u : 0u};
  const std::vector<std::uint16_t> index(cluster.index.begin(), cluster.index.end());
  const auto head_bytes = raw_bytes(head);
  bytes.insert(bytes.end(), head_bytes.begin(), head_bytes.end());
  append_values(cluster.position, bytes), append_values(cluster.uv, bytes);
  append_values(cluster.rgba, bytes), append_values(cluster.normal, bytes);
  append_values(cluster.normal_uv, bytes), append_values(cluster.tangent, bytes);
  append_values(cluster.id_uv, bytes);
  append_values(index, bytes);
  const auto all = std::span<const std::uint8_t>(bytes).subspan(begin);
  return {begin, checksum_of(all), all.size()};
}

ScratchBytes TileFileWriter::store(std::span<const std::uint8_t> bytes) {
  return {file_.append(bytes), checksum_of(bytes), bytes.size()};
}

void TileFileWriter::publish(std::span<const std::uint8_t> directory) {
  const ScratchBytes stored = store(directory);
  const Trailer trailer{stored.offset, stored.bytes, stored.checksum};
  file_.append(raw_bytes(trailer));
  file_.publish();
}

std::shared_ptr<const TileFile> TileFile::open(const std::filesystem::path& path) {
  auto tile = std::make_shared<TileFile>();
  tile->path_ = path;
  tile->file_ = Descriptor(path, O_RDONLY);
  if (!tile->file_.is_open()) return nullptr;
  const std::uint64_t size = size_of(tile->file_);
  Trailer trailer;
  if (size < sizeof trailer ||
      !read_at(tile->file_, size - sizeof trailer, {reinterpret_cast<std::uint8_t*>(&trailer), sizeof trailer}))
    return nullptr;
  if (trailer.mark != magic || trailer.version != tile_file_version || trailer.offset > size ||
      trailer.bytes != size - sizeof trailer - trailer.offset)
    return nullptr;
  tile->directory_.resize(trailer.bytes);
  if (!read_at(tile->file_, trailer.offset, tile->directory_) || checksum_of(tile->directory_) != trailer.checksum)
    return nullptr;
  return tile;
}

void TileFile::fail_other_bytes(const ScratchBytes& stored) const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  throw IoError(path_, "", "differs from the data written; the scratch file is created again at the next attempt",
                stored.offset);
}

std::vector<std::uint8_t> TileFile::read(const ScratchBytes& stored) const {
  std::vector<std::uint8_t> bytes(stored.bytes);
  const bool is_read = read_at(file_, stored.offset, bytes);
  if (!is_read && errno != 0) throw IoError(path_, "", std::string("cannot read: ") + std::strerror(errno));
  if (!is_read || checksum_of(bytes) != stored.checksum) fail_other_bytes(stored);
  return bytes;
}

Primitive TileFile::read_cluster(const ScratchBytes& cluster) const {
  const std::vector<std::uint8_t> bytes = read(cluster);
  ClusterHead head;
  if (bytes.size() >= sizeof head) std::memcpy(&head, bytes.data(), sizeof head);
  if (bytes.size() < sizeof head || head.bytes() != bytes.size()) fail_other_bytes(cluster);
  Primitive mesh;
  std::vector<std::uint16_t> index;
  const std::uint8_t* from = bytes.data() + sizeof head;
  from = take(from, 3 * std::size_t(head.vertices), mesh.position);
  from = take(from, 2 * std::size_t(head.vertices) * head.has_uv, mesh.uv);
  from = take(from, 4 * std::size_t(head.vertices) * head.has_rgba, mesh.rgba);
  from = take(from, std::size_t(head.vertices) * head.has_normal, mesh.normal);
  from = take(from, 2 * std::size_t(head.vertices) * head.has_normal_uv, mesh.normal_uv);
  from = take(from, std::size_t(head.vertices) * head.has_tangent, mesh.tangent);
  from = take(from, 2 * std::size_t(head.vertices) * head.has_id_uv, mesh.id_uv);
  mesh.shares_uv = head.shares_uv != 0;
  take(from, head.corners, index);
  mesh.index.assign(index.begin(), index.end());
  return mesh;
}

}  // namespace gigabake
