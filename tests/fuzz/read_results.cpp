// Readers of the results of bakes and exports.
#include <cstring>
#include <filesystem>

#include "core/octree/parameters.h"
#include "format/export/gigavoxels/gigavoxel_read.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/shard.h"
#include "format/shard/shard_pages.h"
#include "format/shard/shard_reader.h"
#include "tests/format/source/source_scene.h"
#include "tests/fuzz/readers.h"

namespace gigabake::fuzz {
namespace {

using Path = std::filesystem::path;

Path written(const test::SourceFolder& folder, const char* name, Bytes bytes) {
  return folder.write(name, std::string(bytes.begin(), bytes.end()));
}

const test::SourceFolder& scratch() {
  static const test::SourceFolder folder;
  return folder;
}

}  // namespace

void shard(Bytes bytes) {
  const Path file = written(scratch(), "shard.h5", bytes);
  ShardReader(file).check_chunk_table();
  ShardReader(file).unreadable_columns();
  const ShardPages pages(file);
  for (int lod = 0; lod < int(pages.header().lods); ++lod)
    if (pages.bricks(lod) != 0) pages.level(lod, 0, 64);
  pages.nodes(0, 64);
  read_shard(file);
}

void scene_xml(Bytes bytes) {
  const SceneDescription scene = read_scene(written(scratch(), "scene.xml", bytes));
  parameters_from_json(scene.parameters);
  const Path again = scratch().path() / "again.xml";
  write_scene(again, scene);
  if (read_scene(again).cells.size() != scene.cells.size()) throw FaultFound("a scene written again has other cells");
}

void gigavoxel_list(Bytes bytes) { gigavoxel_tree_files(written(scratch(), "scene.gvp", bytes)); }

void gigavoxel_tree(Bytes bytes) {
  const std::vector<Bytes> parts = parts_of(bytes);
  const GigavoxelTree tree = read_gigavoxel_tree(written(scratch(), "tree.gvo", parts[0]));
  const Path bricks = written(scratch(), "voxels.gvb", parts.size() > 1 ? parts[1] : Bytes());
  for (std::uint32_t depth = 0; depth < tree.header.max_depth; ++depth)
    for_each_gigavoxel(tree, depth, bricks, [](const GigavoxelBox&) {});
}

}  // namespace gigabake::fuzz
