#include "worker/tiles/tile_gatherer.h"

#include <algorithm>
#include <utility>

#include "format/source/mesh_parts.h"
#include "worker/tiles/clusters.h"

namespace gigabake {
namespace {

/// Max size of a batch of parts, relative to the max size of a tile in memory (a 128th of the memory limit).
constexpr std::uint64_t max_batch = 4;

std::uint64_t list_bytes(const Primitive& p) {
  return 4 * (p.position.size() + p.index.size() + p.uv.size() + p.normal.size() + p.normal_uv.size() +
              p.tangent.size() + p.id_uv.size()) +
         2 * p.rgba.size();
}

/// Returns the approximate size in bytes of a part with part_triangles() triangles. A batch of one part per thread
/// keeps all threads busy.
std::uint64_t part_bytes() { return part_triangles() * 24; }

/// Splits a primitive into clusters and appends these to `bytes`. The clusters' offsets count from the beginning of
/// `bytes`.
TilePrimitive cut_one(const Primitive& mesh, std::vector<std::uint8_t>& bytes) {
  TilePrimitive out;
  out.bounds = bounds_of(mesh);
  out.triangles = mesh.index.size() / 3;
  for_each_cluster(mesh, [&](const Primitive& cluster) {
    out.clusters.push_back({bounds_of(cluster), nullptr, append_cluster(cluster, bytes)});
  });
  return out;
}

}  // namespace

TilePrimitiveCollector::TilePrimitiveCollector(const std::filesystem::path& tile, Limit limit, const ThreadPool& pool)
    : limit_(std::move(limit)), pool_(pool), claim_(tile) {}

TilePrimitiveCollector::~TilePrimitiveCollector() {
  if (cutting_.valid()) cutting_.wait();
  if (writing_.valid()) writing_.wait();
}

void TilePrimitiveCollector::take(Primitive&& primitive) {
  const std::uint64_t bytes = list_bytes(primitive);
  bytes_ += bytes;
  pending_.push_back(std::move(primitive));
  if (limit_.scratch_file.empty()) return claim_.add(bytes, "", "triangles");
  if (!writer_ && bytes_ > limit_.max_bytes) writer_.emplace(limit_.scratch_file);
  const std::uint64_t enough =
      std::clamp(max_batch * limit_.max_bytes, part_bytes(), part_bytes() * std::uint64_t(pool_.threads()));
  if (writer_ && bytes_ >= enough) cut_pending();
}

/// Starts a task that splits the pending batch while the next batch is read and the previous one is written.
void TilePrimitiveCollector::cut_pending() {
  if (cutting_.valid()) cutting_.get();
  bytes_ = 0;
  cutting_ = std::async(std::launch::async, [this, batch = std::exchange(pending_, {})] { cut(batch); });
}

void TilePrimitiveCollector::wait() {
  if (cutting_.valid()) cutting_.get();
  if (writing_.valid()) writing_.get();
}

void TilePrimitiveCollector::cut(const std::vector<Primitive>& batch) {
  std::vector<TilePrimitive> done(batch.size());
  std::vector<std::vector<std::uint8_t>>& bytes = cut_bytes_[cut_batches_++ % cut_bytes_.size()];
  if (bytes.size() < batch.size()) bytes.resize(batch.size());
  pool_.parallel_for(batch.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      bytes[i].clear();
      done[i] = cut_one(batch[i], bytes[i]);
    }
  });
  if (writing_.valid()) writing_.get();
  // One thread writes: the system lets several threads write to a file only one after the other.
  writing_ = std::async(std::launch::async, [this, &bytes, done = std::move(done)]() mutable {
    for (std::size_t i = 0; i < done.size(); ++i) {
      const std::uint64_t begin = writer_->append_clusters(bytes[i]);
      for (TileCluster& c : done[i].clusters) c.stored.offset += begin;
      cut_.push_back(std::move(done[i]));
    }
  });
}

TileDirectory TilePrimitiveCollector::finish(TileMesh&& mesh) {
  TileDirectory all{std::move(mesh), {}, {}};
  for (EncodedImage& image : std::exchange(all.mesh.images, {})) all.images.push_back(tile_image(std::move(image)));
  if (writer_) {
    cut_pending();
    wait();
    cut_bytes_ = {};
    all.primitives = std::move(cut_);
    for (TileImage& image : all.images) image.stored = writer_->store(std::exchange(image.encoded.bytes, {}));
    writer_->publish(to_bytes(all));
    return all;
  }
  for (Primitive& p : pending_) {
    const LocalBounds bounds = bounds_of(p);
    const std::uint64_t triangles = p.index.size() / 3;
    all.primitives.push_back({bounds, triangles, {{bounds, std::make_shared<const Primitive>(std::move(p))}}});
  }
  pending_.clear();
  return all;
}

}  // namespace gigabake
