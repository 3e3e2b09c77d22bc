#include "format/job/fingerprint.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <tuple>
#include <utility>
#include <xxhash.h>

#include "core/base/kernel_version.h"
#include "core/io/bytes.h"
#include "format/edit/edited_fingerprint.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

/// Version of the fingerprints. Increment it if shards of the current version may not match their fingerprints. Version
/// 1 is rejected: its shards may come from other options than their fingerprints.
constexpr std::uint32_t fingerprint_version = 2;
/// Precedes the edits of a tile.
constexpr std::uint32_t edits_mark = 0x74696465;
/// Precedes the level of a tile.
constexpr std::uint32_t level_mark = 0x6c65766c;

}  // namespace

CellFingerprints::CellFingerprints(const BakeParameters& parameters, const std::optional<Geodetic>& origin,
                                   std::shared_ptr<const Area> area, std::shared_ptr<const EditList> edits)
    : frame_{parameters.voxel_size_m, parameters.lattice_origin_m} {
  if (area) area_.emplace(std::move(area), origin);
  if (edits) edits_.emplace(std::move(edits), origin, frame_);
  ByteWriter w;
  w.put(fingerprint_version);
  w.put(kernel_version);
  w.put(to_json(parameters));
  w.put(std::uint8_t(origin.has_value()));
  if (origin) w.put(*origin);
  shared_ = w.take();
}

CellFingerprints::CellFingerprints(const BakeParameters& parameters, const SceneSources& sources)
    : CellFingerprints(parameters, sources.origin, sources.area, sources.edits) {
  if (parameters.coarsest_lod != 0)
    for (const TileRef& tile : sources.tiles) lod_of_tile_.push_back(tile.lod);
  for (const TileRef& tile : sources.tiles)
    if (tile.edits && !source_edits_.contains(tile.edits.get()))
      source_edits_.emplace(tile.edits.get(), placed_edits(*tile.edits, sources.origin));
  if (source_edits_.empty()) return;
  for (const TileRef& tile : sources.tiles) edits_of_tile_.push_back(tile.edits.get());
}

void CellFingerprints::add_levels(const CellJob& job, std::vector<Hash128>& tile_sources) const {
  for (std::size_t i = 0; i < job.tiles.size() && !lod_of_tile_.empty(); ++i) {
    const std::uint8_t lod = lod_of_tile_.at(job.tiles[i]);
    if (lod == 0) continue;
    ByteWriter w;
    w.put(level_mark), w.put(tile_sources.at(i)), w.put(lod);
    tile_sources[i] = hash_of_bytes(w.take());
  }
}

void CellFingerprints::add_source_edits(const CellJob& job, std::vector<Hash128>& tile_sources) const {
  if (edits_of_tile_.empty()) return;
  const SceneRange cell = range_of(frame_, Box3i64::cube(job.lattice_min, job.cell_voxels));
  for (std::size_t i = 0; i < job.tiles.size(); ++i) {
    const SourceEdits* edits = edits_of_tile_.at(job.tiles[i]);
    if (edits == nullptr) continue;
    ByteWriter w;
    w.put(edits_mark), w.put(tile_sources.at(i));
    bool is_affected = false;
    for (const SourceEditInScene& edit : source_edits_.at(edits))
      if (edit.affects(cell)) is_affected = true, w.put(edit.hash());
    if (is_affected) tile_sources[i] = hash_of_bytes(w.take());
  }
}

std::vector<std::uint32_t> CellFingerprints::edits_of(const CellJob& job) const {
  if (!edits_) return {};
  return edits_->selecting(Box3i64::cube(job.lattice_min, job.cell_voxels));
}

Hash128 CellFingerprints::of(const CellJob& job, std::vector<Hash128> tile_sources) const {
  Hash128 fingerprint = without_edits(job, std::move(tile_sources));
  for (const std::uint32_t e : edits_of(job)) fingerprint = edited_fingerprint(fingerprint, edits_->hash(e));
  return fingerprint;
}

std::vector<CellFingerprints::EarlierEdits> CellFingerprints::with_fewer_edits(const CellJob& job) const {
  const std::vector<std::uint32_t> edits = edits_of(job);
  std::vector<EarlierEdits> all{{0, without_edits(job, job.tile_sources)}};
  for (const std::uint32_t e : edits)
    all.push_back({all.size(), edited_fingerprint(all.back().fingerprint, edits_->hash(e))});
  all.pop_back();  // the result with all edits
  std::reverse(all.begin(), all.end());
  if (all.size() > max_earlier_edits + 1) all.erase(all.begin() + max_earlier_edits, all.end() - 1);
  return all;
}

Hash128 CellFingerprints::without_edits(const CellJob& job, std::vector<Hash128> tile_sources) const {
  add_levels(job, tile_sources);
  add_source_edits(job, tile_sources);
  std::sort(tile_sources.begin(), tile_sources.end(),
            [](const Hash128& a, const Hash128& b) { return std::tie(a.hi, a.lo) < std::tie(b.hi, b.lo); });
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  XXH3_128bits_update(&state, shared_.data(), shared_.size());
  XXH3_128bits_update(&state, &job.lattice_min, sizeof job.lattice_min);
  XXH3_128bits_update(&state, &job.cell_voxels, sizeof job.cell_voxels);
  XXH3_128bits_update(&state, tile_sources.data(), tile_sources.size() * sizeof(Hash128));
  const auto voxels = Box3i64::cube(job.lattice_min, job.cell_voxels);
  if (area_ && area_->overlap(frame_, voxels) != AreaOverlap::inside) {
    const Hash128 border = area_->border_hash(frame_, voxels);
    XXH3_128bits_update(&state, &border, sizeof border);
  }
  const XXH128_hash_t h = XXH3_128bits_digest(&state);
  return {h.low64, h.high64};
}

bool CellFingerprints::match(const CellJob& job) const {
  if (is_overview(job) || (job.tile_sources.empty() && !job.tiles.empty())) return true;
  return of(job, job.tile_sources) == job.fingerprint;
}

}  // namespace gigabake
