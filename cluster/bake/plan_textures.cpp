#include "cluster/bake/plan_textures.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "format/source/tile_hash.h"
#include "worker/scan/texel_size.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {
namespace {

constexpr double max_sampling_s = 0.5;
constexpr std::size_t sampled_clusters = 256;  ///< per primitive of a large tile

/// Returns the images of a tile, and clusters spread evenly over each primitive.
TileMesh sample_of(const LoadedTile& tile) {
  TileMesh sample = tile.mesh();
  for (std::size_t p = 0; p < sample.primitives.size(); ++p) {
    const std::vector<TileCluster>& clusters = tile.primitives()[p].clusters;
    const std::size_t stride = std::max<std::size_t>(1, clusters.size() / sampled_clusters);
    std::vector<const TileCluster*> some;
    for (std::size_t i = 0; i < clusters.size(); i += stride) some.push_back(&clusters[i]);
    const int material = sample.primitives[p].material;
    if (const auto mesh = tile.mesh_of(some)) sample.primitives[p] = *mesh;
    sample.primitives[p].material = material;
  }
  for (std::size_t i = 0; i < tile.images().size(); ++i) sample.images.push_back(tile.encoded(i));
  return sample;
}

class TextureStatistics {
 public:
  TextureStatistics(const SceneSources& sources, const TileStore& store, std::uint64_t max_bytes)
      : sources_(sources), store_(store), max_bytes_(max_bytes) {}

  void add(std::uint32_t tile) {
    const TileRef& ref = sources_.tiles.at(tile);
    TileMesh mesh = store_.may_be_large(tile) ? sample_of(*store_.load(tile, tile_hash(ref, sources_.root)))
                                              : read_tile(ref, sources_.root, ReadScope::everything);
    texels_.add(texel_size(mesh));
    for (EncodedImage& encoded : mesh.images) {
      const TileImage image = tile_image(std::move(encoded));
      if (image.texture_bytes > max_bytes_ && seen_.insert({image.hash.hi, image.hash.lo}).second)
        scratch_bytes_ += double(image.texture_bytes);
    }
    looked_at_bytes_ += double(ref.bytes);
  }

  TextureFindings findings() const {
    TextureFindings out;
    out.texel_m = texels_.mean_m();
    double all_bytes = 0;
    for (const TileRef& tile : sources_.tiles) all_bytes += double(tile.bytes);
    if (looked_at_bytes_ > 0) out.scratch_bytes = std::uint64_t(scratch_bytes_ * all_bytes / looked_at_bytes_ + 0.5);
    return out;
  }

 private:
  const SceneSources& sources_;
  const TileStore& store_;
  const std::uint64_t max_bytes_;
  TexelSize texels_;
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen_;  ///< hashes of counted images; tiles may share images
  double scratch_bytes_ = 0, looked_at_bytes_ = 0;
};

}  // namespace

TextureFindings examine_textures(const SceneSources& sources, const std::vector<std::uint32_t>& tiles,
                                 const TileStore& store, std::uint64_t max_bytes) {
  TextureStatistics look(sources, store, max_bytes);
  const auto start = std::chrono::steady_clock::now();
  for (const std::uint32_t tile : tiles) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > max_sampling_s) break;
    try {
      look.add(tile);
    } catch (const std::exception&) {
      continue;  // the tile changed since the scan; the next tile serves as well
    }
  }
  return look.findings();
}

}  // namespace gigabake
