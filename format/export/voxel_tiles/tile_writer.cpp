#include "format/export/voxel_tiles/tile_writer.h"

#include <span>
#include <utility>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "core/octree/morton.h"
#include "format/system/hash_bytes.h"
#include "format/system/output_file.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

/// Converts a padded box of level `lod` to voxels of level 0. Extends it by one voxel of level `lod`, for shards whose
/// levels are not aligned with the lattice.
Box3i64 reach_of(const Box3i64& box, int lod) {
  Box3i64 reach = on_lattice(box, lod);
  reach.end += Vec3i64::all(std::int64_t(1) << lod);
  return reach;
}

GridOrder order_of(TilesetForm form) {
  return form == TilesetForm::gltf_2_1 ? GridOrder::right_forward_up : GridOrder::y_up;
}

}  // namespace

TileBox box_of(const VoxelTiling& tiling, const SceneHeader& scene, const TilePlace& tile) {
  const double voxel_m = scene.voxel_size_m;
  const double edge_m = double(std::int64_t(tiling.edge) << tiling.lod(tile.level)) * voxel_m;
  const Vec3d corner_m = scene.lattice_origin_m + Vec3d(tiling.corner) * voxel_m;
  return {corner_m + (Vec3d(demorton(tile.key)) + Vec3d::all(0.5)) * edge_m, edge_m};
}

TileWriter::TileWriter(const TileSource& source, std::filesystem::path target, std::filesystem::path folder)
    : source_(source),
      target_(std::move(target)),
      folder_(std::move(folder)),
      grid_(source.tiling.edge, source.scene.header(), order_of(source.form)) {}

TileRecord TileWriter::write(const TilePlace& tile) {
  fill(tile);
  return write_file(tile);
}

std::optional<Hash128> TileWriter::made_of(const TilePlace& tile) {
  const int lod = source_.tiling.lod(tile.level);
  if (source_.made.has(lod)) return std::nullopt;
  ByteWriter writer;
  for_each_shard_of(tile, near_, [&](const SceneCell& shard) {
    writer.put(shard.lattice_min);
    writer.put(shard.cell_voxels);
    writer.put(shard.content_hash.at(std::size_t(lod) - shard.first_lod));
  });
  return hash_of_bytes(writer.take());
}

bool TileWriter::take_over(const TilePlace& tile, const TileRecord& record, const std::filesystem::path& from) {
  const std::filesystem::path earlier = from / name_of(tile), to = folder_ / name_of(tile);
  std::error_code failed;
  if (std::filesystem::file_size(earlier, failed) != record.bytes || failed) return false;
  if (hash_of_bytes(read_whole_file(earlier)) != record.checksum) return false;
  std::filesystem::create_directories(to.parent_path());
  std::filesystem::create_hard_link(earlier, to, failed);
  if (failed) std::filesystem::copy_file(earlier, to, failed);
  if (failed) throw InputError(to, "", "cannot be written: " + failed.message());
  return true;
}

TileRecord TileWriter::write_empty(const TilePlace& tile) {
  grid_.clear(source_.tiling.padded_box(tile));
  return write_file(tile);
}

void TileWriter::fill(const TilePlace& tile) {
  const Box3i64 box = source_.tiling.padded_box(tile);
  const int lod = source_.tiling.lod(tile.level);
  const auto set = [this](const LevelIndex& at, const std::uint8_t* rgba, const std::int8_t* normal,
                          VoxelClass voxel_class) { grid_.set(at, rgba, normal, voxel_class); };
  grid_.clear(box);
  if (source_.made.has(lod)) {
    for (const DerivedLevels::Voxel& v : source_.made.level(lod))
      if (box.contains(v.at)) set(v.at, v.rgba.data(), v.normal.data(), v.voxel_class);
    return;
  }
  for_each_shard_of(tile, near_,
                    [&](const SceneCell& shard) { source_.levels.get(shard, lod)->for_each_voxel_in(box, set); });
}

void TileWriter::read_ahead(const TilePlace& tile) {
  const int lod = source_.tiling.lod(tile.level);
  if (source_.made.has(lod)) return;
  for_each_shard_of(tile, ahead_, [&](const SceneCell& shard) { source_.levels.read_ahead(shard, lod); });
}

/// Calls visit(shard) for each shard that has voxels of the tile or of its padding.
template <class Visit>
void TileWriter::for_each_shard_of(const TilePlace& tile, BlockOwners& near, const Visit& visit) {
  const Box3i64 reach = reach_of(source_.tiling.padded_box(tile), source_.tiling.lod(tile.level));
  for (const LevelOwner& owner : owners_near(tile, near))
    if (!intersection(window_of(owner.shard), reach).is_empty()) visit(owner.shard);
}

const std::vector<LevelOwner>& TileWriter::owners_near(const TilePlace& tile, BlockOwners& near) {
  const TilePlace block{tile.level, tile.key >> 6 << 6};
  if (block == near.block) return near.owners;
  const int lod = source_.tiling.lod(tile.level);
  Box3i64 box = source_.tiling.padded_box(block);
  box.end += Vec3i64::all(3 * std::int64_t(source_.tiling.edge));
  near.owners = source_.owners.of(lod, reach_of(box, lod));
  near.block = block;
  return near.owners;
}

TileRecord TileWriter::write_file(const TilePlace& tile) {
  OutputFile out(target_, folder_ / name_of(tile));
  const TileBox box = box_of(source_.tiling, source_.scene.header(), tile);
  source_.form == TilesetForm::gltf_2_1 ? make_voxel_node(grid_, box, file_) : make_voxel_tile(grid_, box, file_);
  const std::span<const std::uint8_t> packed = packer_.packed(file_);
  out.write(packed);
  out.finish();
  return {{}, grid_.statistics(), packed.size(), hash_of_bytes(packed)};
}

}  // namespace gigabake
