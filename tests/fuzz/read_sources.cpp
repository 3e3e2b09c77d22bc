// Readers of sources.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/thread_pool.h"
#include "core/math/geodesic.h"
#include "format/area/geojson.h"
#include "format/edit/edits_in_scene.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/source/content/content_magic.h"
#include "format/source/image/image_rows.h"
#include "format/source/levels/source_levels.h"
#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "format/system/read_file.h"
#include "tests/format/source/source_scene.h"
#include "tests/fuzz/readers.h"
#include "worker/edit/edited_mesh.h"
#include "worker/scan/scan_tile.h"

namespace gigabake::fuzz {
namespace {

using Path = std::filesystem::path;
using test::Json;
using test::SourceFolder;

/// Maximum number of tiles that are read: a few bytes of a tileset can place one file a million times.
constexpr std::size_t tiles_read = 3;

std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

/// Returns true if the mesh is small. Scanning a mesh across millions of columns takes seconds, too long for a fuzzer.
bool is_small(const TileMesh& mesh) {
  constexpr double max_m = 1e5;
  constexpr std::size_t max_points = 100'000;
  std::size_t points = 0;
  Point<Scene> first{};
  for (const Instance& i : mesh.instances) {
    const std::vector<float>& p = mesh.primitives[std::size_t(i.primitive)].position;
    for (std::size_t v = 0; v + 2 < p.size(); v += 3) {
      const Point<Scene> at = i.scene_from_local({p[v], p[v + 1], p[v + 2]});
      if (points++ == 0) first = at;
      if (std::fabs(at.x - first.x) > max_m || std::fabs(at.y - first.y) > max_m || points > max_points) return false;
    }
  }
  return true;
}

/// Checks that the tile read in parts has as many triangles as the whole tile. If one way of reading fails, the other
/// must fail.
void read_in_parts(const TileRef& tile, const Path& root) {
  std::uint64_t triangles = 0;
  std::optional<TileMesh> whole, parts;
  try {
    whole = read_tile(tile, root, ReadScope::everything);
  } catch (const InputError&) {
  }
  try {
    parts = read_tile(tile, root, ReadScope::everything,
                      [&](std::size_t, Primitive&& p) { triangles += p.index.size() / 3; });
  } catch (const InputError&) {
  }
  if (whole.has_value() != parts.has_value()) throw FaultFound("parts are read, or refused, and the whole is not");
  if (!whole) return;
  for (const Primitive& p : whole->primitives) triangles -= p.index.size() / 3;
  if (triangles != 0) throw FaultFound("parts of other triangles than the whole has");
}

/// Applies the edits of a source to all instances.
void edit(const TileMesh& mesh, const SourceEditsInScene& edits) {
  MemoryClaim memory("tile");
  for (const Instance& instance : mesh.instances)
    edited_mesh(std::make_shared<const Primitive>(mesh.primitives.at(std::size_t(instance.primitive))),
                instance.scene_from_local, edits, memory);
}

void read_as_a_bake_does(const Path& file) {
  static const ThreadPool pool(1);
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  SceneSources sources = open_sources(file, {});
  BakeParameters with_levels = parameters;
  set_source_levels(sources, with_levels);
  parameters.coarsest_lod = with_levels.coarsest_lod;  // keeps the voxel size, because small voxels take much time
  if (sources.edits)
    EditsInScene(sources.edits, sources.origin, {parameters.voxel_size_m, {}}).selecting(Box3i64::cube({0, 0, 0}, 32));
  for (std::uint32_t t = 0; t < std::min(tiles_read, sources.tiles.size()); ++t) {
    const TileRef& tile = sources.tiles[t];
    identify_tile(tile, sources.root);
    read_in_parts(tile, sources.root);
    const TileMesh mesh = read_tile(tile, sources.root, ReadScope::everything);
    if (is_small(mesh)) scan_tile(sources, t, parameters, pool);
    if (is_small(mesh) && tile.edits) edit(mesh, placed_edits(*tile.edits, sources.origin));
    for (const Primitive& p : mesh.primitives)
      for (const std::uint32_t vertex : p.index)
        if (3 * std::size_t(vertex) >= p.position.size()) throw FaultFound("an index beyond the vertices");
    for (const EncodedImage& i : mesh.images)
      if (!i.bytes.empty()) decode_image(i);
  }
}

/// A folder with the files that the URIs of fuzzed sources may name.
class Neighbours {
 public:
  Neighbours() {
    folder_.write("model.gltf", test::square_gltf());
    folder_.write("nested.json", test::tileset(test::tile("model.gltf")));
    folder_.write("set.json", test::tileset(test::tile("model.gltf")));
    const Json all{{"constant", 1}}, none{{"constant", 0}};
    folder_.write("all.subtree", Json{{"tileAvailability", all},
                                      {"contentAvailability", Json::array({all})},
                                      {"childSubtreeAvailability", none}});
  }
  Path with(const std::string& name, Bytes bytes) const { return folder_.write(name, text_of(bytes)); }
  Path with(const std::string& name, const Json& json) const { return folder_.write(name, json); }

 private:
  SourceFolder folder_;
};

const Neighbours& neighbours() {
  static const Neighbours folder;
  return folder;
}

/// Returns an implicit tileset whose subtrees are all in one file.
Json implicit_tileset(const char* scheme, int levels) {
  const Json content{{"uri", "model.gltf"}};
  Json root = test::tile("");
  root["contents"] = Json::array({content, content});
  root["implicitTiling"] = {{"subdivisionScheme", scheme},
                            {"subtreeLevels", 2},
                            {"availableLevels", levels},
                            {"subtrees", {{"uri", "one.subtree"}}}};
  return test::tileset(root);
}

}  // namespace

void gltf(Bytes bytes) {
  const std::vector<Bytes> parts = parts_of(bytes);
  neighbours().with("data.bin", parts.size() > 1 ? parts[1] : Bytes());
  const bool is_binary = content_magic(parts[0]) == ContentMagic::glb;
  read_as_a_bake_does(neighbours().with(is_binary ? "tile.glb" : "tile.gltf", parts[0]));
}

void tile(Bytes bytes) {
  const ContentMagic magic = content_magic(bytes);
  const char* const name = magic == ContentMagic::composite ? "tile.cmpt"
                           : magic == ContentMagic::i3dm    ? "tile.i3dm"
                                                            : "tile.b3dm";
  read_as_a_bake_does(neighbours().with(name, bytes));
}

void tileset(Bytes bytes) { read_as_a_bake_does(neighbours().with("tileset.json", bytes)); }

void subtree(Bytes bytes) {
  const std::vector<Bytes> parts = parts_of(bytes);
  neighbours().with("bits.bin", parts.size() > 1 ? parts[1] : Bytes());
  neighbours().with("one.subtree", parts[0]);
  static const Path quadtree = neighbours().with("quadtree.json", implicit_tileset("QUADTREE", 4));
  static const Path octree = neighbours().with("octree.json", implicit_tileset("OCTREE", 3));
  for (const Path& file : {quadtree, octree}) open_sources(file, {});
}

void archive(Bytes bytes) { read_as_a_bake_does(neighbours().with("set.3tz", bytes)); }

void scene_json(Bytes bytes) { read_as_a_bake_does(neighbours().with("scene.json", bytes)); }

void obj(Bytes bytes) {
  const std::vector<Bytes> parts = parts_of(bytes);
  neighbours().with("material.mtl", parts.size() > 1 ? parts[1] : Bytes());
  read_as_a_bake_does(neighbours().with("tile.obj", parts[0]));
}

void ply(Bytes bytes) {
  const std::vector<Bytes> parts = parts_of(bytes);
  neighbours().with("one.png", parts.size() > 1 ? parts[1] : Bytes());
  read_as_a_bake_does(neighbours().with("tile.ply", parts[0]));
}

void stl(Bytes bytes) { read_as_a_bake_does(neighbours().with("tile.stl", bytes)); }

void raster(Bytes bytes) {
  neighbours().with("raster.tif", bytes);
  static const Path scene = [] {
    const Json dem{{"dem", "raster.tif"}, {"crs", "EPSG:25832"}, {"height_scale", 1}, {"tile_cells", 16}};
    return neighbours().with("raster.json", Json{{"gigabake", 1}, {"sources", Json::array({dem})}});
  }();
  read_as_a_bake_does(scene);
}

void orthophoto(Bytes bytes) {
  neighbours().with("photo.tif", bytes);
  static const Path scene = [] {
    std::string grid = "ncols 17\nnrows 17\nxllcorner 500000\nyllcorner 5100000\ncellsize 10\n";
    for (int i = 0; i < 17 * 17; ++i) grid += std::to_string(i % 5) + (i % 17 == 16 ? "\n" : " ");
    const Json dem{{"dem", "grid.asc"}, {"ortho", "photo.tif"}, {"crs", "EPSG:25832"}, {"tile_cells", 16}};
    neighbours().with("grid.asc", Bytes(reinterpret_cast<const std::uint8_t*>(grid.data()), grid.size()));
    return neighbours().with("photo.json", Json{{"gigabake", 1}, {"sources", Json::array({dem})}});
  }();
  read_as_a_bake_does(scene);
}

/// Checks that an image that can be decoded by rows has the texels of the image that is decoded whole.
void image(Bytes bytes) {
  const EncodedImage encoded{"image", {bytes.begin(), bytes.end()}};
  const Image whole = decode_image(encoded);
  const auto rows = ImageRows::open(encoded);
  if (rows == nullptr) return;
  std::vector<std::uint8_t> row(std::size_t(4) * std::size_t(whole.width));
  for (std::size_t y = 0; y < std::size_t(whole.height); ++y) {
    rows->next(row.data());
    if (!std::equal(row.begin(), row.end(), whole.rgba.data() + y * row.size()))
      throw FaultFound("a row has other texels than the whole image");
  }
}

namespace {

void read_polygons(const Path& file) {
  for (const AreaPolygon& polygon : read_geojson_polygons(file)) {
    if (fault_of(polygon.rings())) throw FaultFound("a polygon with a fault is accepted");
    const FixedBox all = polygon.bounds();
    if (polygon.overlap(all) != AreaOverlap::border) throw FaultFound("the box of a polygon does not cut its rings");
    const FixedPoint beside{all.high.x + 1, all.low.y};
    if (polygon.contains(beside)) throw FaultFound("a position outside the box of a polygon is inside");
  }
}

void read_line(const Path& file) {
  const GeodesicPath path(read_geojson_line(file));
  for (int i = 0; i <= 8; ++i) {
    const Geodetic p = path.position(path.length_m() * i / 8);
    if (!(std::fabs(p.latitude_deg) <= 90 && std::fabs(p.longitude_deg) <= 180))
      throw FaultFound("a position on a line is not on the earth");
  }
}

}  // namespace

/// Calls both readers. None accepts a file that the other accepts, because they read different geometries.
void geojson(Bytes bytes) {
  const Path file = neighbours().with("area.geojson", bytes);
  std::optional<std::string> refused;
  try {
    read_polygons(file);
  } catch (const InputError& e) {
    refused = e.what();
  }
  if (refused) return read_line(file);
  try {
    read_line(file);
  } catch (const InputError&) {
    return;
  }
  throw FaultFound("a file of polygons is accepted as a line");
}

}  // namespace gigabake::fuzz
