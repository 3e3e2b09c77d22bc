#include "worker/pipeline/shard_from_volume.h"

#include <algorithm>
#include <utility>

namespace gigabake {

namespace {

/// Returns the coarsest level with leaves, counted on the lattice; 0 if there are none.
std::uint32_t leaf_lod_of(const NodeTable& nodes, std::uint32_t first_lod) {
  std::uint32_t lod = 0;
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n)
    if (nodes.leaf_mask[n] != 0) lod = std::max(lod, first_lod + nodes.lod[n]);
  return lod;
}

}  // namespace

Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header) {
  Shard shard;
  shard.header = std::move(header);
  shard.nodes = std::move(volume.nodes);
  for (kernels::Level& level : volume.levels) shard.levels.push_back(std::move(static_cast<BrickLevel&>(level)));
  if (!shard.header.has_directional_coverage) shard.nodes.directional_coverage.clear();
  shard.header.lods = std::uint32_t(shard.levels.size());
  shard.header.leaf_lod = leaf_lod_of(shard.nodes, shard.header.first_lod);
  shard.header.content_hash = std::move(volume.content_hash);
  shard.above = std::move(volume.above);
  return shard;
}

bool is_of_job(const ShardHeader& h, const CellJob& job, const BakeParameters& p,
               const std::optional<Geodetic>& origin) {
  return h.fingerprint == job.fingerprint && h.cell == job.name && h.lattice_min == job.lattice_min &&
         h.cell_voxels == job.cell_voxels && h.first_lod == job.first_lod && h.copied_lods == job.copied_lods &&
         h.voxel_size_m == p.voxel_size_m && h.lattice_origin_m == p.lattice_origin_m && h.origin == origin &&
         h.has_normals == p.normals && h.has_directional_coverage == has_directional_coverage(p) &&
         h.has_classes == p.classes;
}

PackedShard shard_from_packed(kernels::PackedCell& cell, ShardHeader header) {
  PackedShard shard;
  shard.header = std::move(header);
  shard.nodes = std::move(cell.nodes);
  shard.constants = std::move(cell.constants);
  shard.levels = std::move(cell.levels);
  shard.header.lods = std::uint32_t(shard.levels.size());
  shard.header.content_hash = std::move(cell.content_hash);
  shard.above = std::move(cell.above);
  return shard;
}

}  // namespace gigabake
