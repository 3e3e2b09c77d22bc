#include "format/export/gigavoxels/gigavoxel.h"

#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"
#include "format/export/gigavoxels/gigavoxel_files.h"
#include "format/scene/scene_level.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/level_lookup.h"
#include "format/system/publish_folder.h"

namespace gigabake {
namespace {

/// Finds voxel `at` of a cell's level. Returns false if it does not exist, for example outside of the cell.
bool find(LevelLookup& lookup, const Vec3i64& at, std::int64_t edge, VoxelValue& value) {
  for (const std::int64_t x : at)
    if (x < 0 || x >= edge) return false;
  return lookup.find(std::uint32_t(at[0]), std::uint32_t(at[1]), std::uint32_t(at[2]), value);
}

/// Fills the brick whose lowest voxel is `lowest`, and its border. `edge` is the edge of the cell in voxels of the
/// level.
void fill_brick(LevelLookup& lookup, const Vec3i64& lowest, std::int64_t edge, bool normals, GigavoxelBrick& brick) {
  std::size_t i = 0;
  constexpr auto begin = -std::int64_t(GigavoxelBrick::border), end = std::int64_t(brick_edge) - begin;
  for (std::int64_t z = begin; z < end; ++z)
    for (std::int64_t y = begin; y < end; ++y)
      for (std::int64_t x = begin; x < end; ++x, ++i) {
        VoxelValue value{};
        if (!find(lookup, lowest + Vec3i64{x, y, z}, edge, value)) {
          brick.rgba[i] = {};
          brick.gradient[i] = no_gradient;
          continue;
        }
        for (std::size_t c = 0; c < 4; ++c) brick.rgba[i][c] = value.rgba[c];
        brick.gradient[i] = normals ? gradient_bytes(value.normal) : no_gradient;
      }
}

void write_bricks(OutputFile& out, const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod,
                  const Progress& progress) {
  begin_gigavoxel_bricks(out);
  LevelLookup lookup(nodes, level, header.lods, lod);
  GigavoxelBrick brick;
  const LevelNodes rows = level_nodes(nodes, header.lods)[std::size_t(lod)];
  for (std::size_t n = rows.begin; n < rows.end; ++n) {
    if (nodes.kind[n] != NodeKind::brick) continue;
    fill_brick(lookup, Vec3i64(demorton(nodes.key[n])) * brick_edge,
               header.cell_voxels >> (int(header.first_lod) + lod), header.has_normals, brick);
    write_gigavoxel_brick(out, brick);
    progress.advance(0);
  }
  out.finish();
}

class GigavoxelWriter {
 public:
  GigavoxelWriter(const std::filesystem::path& target, const std::filesystem::path& folder, GigavoxelTreeFile kind)
      : target_(target), folder_(folder), kind_(kind) {}

  void write_shard(const PagedScene& scene, const SceneCell& shard, int scene_lod, std::size_t number,
                   const Progress& progress) {
    const auto [header, nodes, finest] = read_level(scene, shard, scene_lod);
    const int lod = scene_lod - int(header.first_lod);
    OutputFile out(target_, folder_ / tree_file(number));
    const GigavoxelTree tree = gigavoxel_tree(header, nodes, lod);
    if (kind_ == GigavoxelTreeFile::xml)
      write_gigavoxel_xml(out, tree);
    else
      write_gigavoxel_binary(out, tree);
    out.finish();
    for (int level = lod; level < int(header.lods); ++level) {
      const std::size_t depth = header.lods - 1 - std::size_t(level);
      OutputFile bricks(target_, folder_ / cell_folder(number) / gigavoxel_brick_file(depth));
      const BrickLevel coarser =
          level == lod ? BrickLevel() : read_level(scene, shard, int(header.first_lod) + level).level;
      write_bricks(bricks, header, nodes, level == lod ? finest : coarser, level, progress);
    }
  }

  void write_scene(const PagedScene& paged, int lod) const {
    const SceneHeader& scene = paged.header();
    OutputFile out(target_, folder_ / "scene.gvp");
    out.write("<OctTreeGroup Compressed=\"NO\" BrickXSize=\"8\" BrickYSize=\"8\" BrickZSize=\"8\">\n");
    std::size_t number = 0;
    for_each_shard_of_level(paged, lod, [&](const SceneCell& cell) {
      const double edge_m = cell.cell_voxels * scene.voxel_size_m;
      const Vec3d corner_m = scene.lattice_origin_m + Vec3d(cell.lattice_min) * scene.voxel_size_m;
      const Vec3d centre_m = corner_m + Vec3d::all(edge_m / 2);
      out.write(
          fmt::format("    <PagedOctTree CenterX=\"{}\" CenterY=\"{}\" CenterZ=\"{}\" Radius=\"{}\" "
                      "SizeXMeters=\"{}\" SizeYMeters=\"{}\" SizeZMeters=\"{}\" TreeFile=\"{}\"/>\n",
                      centre_m[0], centre_m[1], centre_m[2], edge_m * std::sqrt(3.0) / 2, edge_m, edge_m, edge_m,
                      tree_file(number++).string()));
    });
    out.write("</OctTreeGroup>\n");
    out.finish();
  }

 private:
  static std::filesystem::path cell_folder(std::size_t number) { return fmt::format("grid_{}", number); }
  std::filesystem::path tree_file(std::size_t number) const {
    return cell_folder(number) / (kind_ == GigavoxelTreeFile::xml ? "tree.gvx" : "tree.gvo");
  }

  const std::filesystem::path& target_;
  const std::filesystem::path& folder_;
  GigavoxelTreeFile kind_;
};

}  // namespace

std::uint64_t export_gigavoxel(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& folder,
                               GigavoxelTreeFile kind, const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  if (int(scene.header().leaf_lod) > lod)
    throw InputError(scene_xml, "LeafLod",
                     fmt::format("lod {} has leaves of coarser levels, which this format cannot store; use lod {} or "
                                 "coarser, or another format",
                                 lod, scene.header().leaf_lod));
  FolderPublication publication(folder);
  GigavoxelWriter writer(publication.target(), publication.temporary(), kind);
  progress.step("writing the cells", voxels);
  std::size_t number = 0;
  for_each_shard_of_level(scene, lod, [&, &paged = scene](const SceneCell& shard) {
    writer.write_shard(paged, shard, lod, number++, progress);
    progress.advance(shard.voxels[std::size_t(lod) - shard.first_lod]);
  });
  writer.write_scene(scene, lod);
  publication.publish();
  return voxels;
}

}  // namespace gigabake
