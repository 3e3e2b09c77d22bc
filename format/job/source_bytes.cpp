#include "format/job/source_bytes.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/io/bytes.h"
#include "format/area/area.h"
#include "format/edit/edit_json.h"
#include "format/edit/source_edit_json.h"
#include "format/job/raster_bytes.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/raster/crs_map.h"
#include "format/source/raster/dem.h"
#include "format/source/tiles/archive.h"

namespace gigabake {
namespace {

using namespace source_bytes;

/// Max length of the prefix that a tile's name shares with the previous one. Without this bound, malformed bytes could
/// request any amount of memory.
constexpr std::size_t max_shared_prefix = 4096;

/// The parts that a tile has in addition to its placement.
enum TileFlag : std::uint8_t {
  has_range = 1,
  has_archive = 2,
  has_raster = 4,
  has_edits = 8,
  has_lod = 16,
  has_classes = 32,
  has_named_sizes = 64,
  all_flags = 127
};

/// Archives or rasters that many tiles share. Each part is written once; tiles refer to the part by number.
template <class Part>
class Shared {
 public:
  void add(const std::shared_ptr<const Part>& part) {
    if (part && numbers_.emplace(part.get(), std::uint32_t(parts_.size())).second) parts_.push_back(part);
  }
  std::uint32_t number(const std::shared_ptr<const Part>& part) const { return numbers_.at(part.get()); }
  const std::vector<std::shared_ptr<const Part>>& parts() const { return parts_; }

 private:
  std::map<const Part*, std::uint32_t> numbers_;
  std::vector<std::shared_ptr<const Part>> parts_;
};

/// Writes the number of parts, then each part by put(part).
template <class Part, class Put>
void put_all(ByteWriter& w, const Shared<Part>& shared, const Put& put) {
  w.put(std::uint64_t(shared.parts().size()));
  for (const auto& part : shared.parts()) put(*part);
}

/// Reads what put_all() wrote. Does not reserve memory, because the count is not trusted.
template <class Parts, class Get>
void get_all(ByteReader& r, Parts& parts, const Get& get) {
  std::uint64_t count = 0;
  for (r.get(count); count > 0; --count) parts.push_back(get());
}

/// Writes the length of the prefix shared with the previous text, and the rest of the text.
void put_next(ByteWriter& w, const std::string& before, const std::string& text) {
  const auto [end, ignored] = std::ranges::mismatch(before, text);
  const std::size_t shared = std::min(std::size_t(end - before.begin()), max_shared_prefix);
  w.put(std::uint16_t(shared));
  w.put(text.substr(shared));
}

void get_next(ByteReader& r, std::string& text) {
  std::uint16_t shared = 0;
  std::string rest;
  r.get(shared), r.get(rest);
  if (shared > std::min(text.size(), max_shared_prefix)) refuse("tile.name", "a prefix of the previous tile's name");
  text.resize(shared);
  text += rest;
}

constexpr std::size_t place_rows = 3, place_columns = 4;

/// Writes only the numbers that differ from the previous placement. Compares bits, because a placement is part of a
/// tile's identity.
template <class Place>
void put_next_place(ByteWriter& w, const Place& before, const Place& place) {
  const auto differs = [&](std::size_t row, std::size_t column) {
    return std::memcmp(&before.m[row][column], &place.m[row][column], sizeof(double)) != 0;
  };
  std::uint16_t changed = 0;
  for (std::size_t i = 0; i < place_rows * place_columns; ++i)
    if (differs(i / place_columns, i % place_columns)) changed |= std::uint16_t(1u << i);
  w.put(changed);
  for (std::size_t i = 0; i < place_rows * place_columns; ++i)
    if ((changed >> i & 1) != 0) w.put(place.m[i / place_columns][i % place_columns]);
}

template <class Place>
void get_next_place(ByteReader& r, Place& place) {
  std::uint16_t changed = 0;
  r.get(changed);
  if (changed >> (place_rows * place_columns) != 0) refuse("tile.place", "twelve numbers");
  for (std::size_t i = 0; i < place_rows * place_columns; ++i)
    if ((changed >> i & 1) != 0) r.get(place.m[i / place_columns][i % place_columns]);
}

class TileWriter {
 public:
  explicit TileWriter(ByteWriter& w) : w_(w) {}

  void put_shared(const std::vector<TileRef>& tiles) {
    for (const TileRef& tile : tiles) {
      archives_.add(tile.archive);
      if (tile.dem) rasters_.add(tile.dem->raster);
      edits_.add(tile.edits);
      classes_.add(tile.classes);
      named_sizes_.add(tile.named_sizes);
    }
    put_all(w_, archives_, [this](const Archive& archive) { w_.put(archive.file().string()); });
    put_all(w_, rasters_, [this](const DemRaster& raster) { put_raster(w_, raster); });
    put_all(w_, edits_, [this](const SourceEdits& edits) { w_.put(to_json(edits)); });
    const auto put_stated = [this](const auto& part) {
      w_.put(to_json(part)), w_.put(part.file.string()), w_.put(part.key);
    };
    put_all(w_, classes_, put_stated), put_all(w_, named_sizes_, put_stated);
  }

  void put(const TileRef& tile) {
    w_.put(std::uint8_t(tile.kind)), w_.put(std::uint8_t(tile.gltf_up));
    w_.put(std::uint8_t((tile.range == ByteRange{} ? 0 : has_range) | (tile.archive ? has_archive : 0) |
                        (tile.dem ? has_raster : 0) | (tile.edits ? has_edits : 0) | (tile.lod != 0 ? has_lod : 0) |
                        (tile.classes ? has_classes : 0) | (tile.named_sizes ? has_named_sizes : 0)));
    put_next(w_, path_, tile.path.string());
    put_next(w_, name_, tile.name);
    w_.put(tile.bytes);
    put_next_place(w_, scene_, tile.scene_from_tile);
    put_next_place(w_, world_, tile.world_from_tile);
    if (tile.range != ByteRange{}) w_.put(tile.range);
    if (tile.archive) w_.put(archives_.number(tile.archive));
    if (tile.dem) put_dem(w_, *tile.dem, rasters_.number(tile.dem->raster));
    if (tile.edits) w_.put(edits_.number(tile.edits));
    if (tile.lod != 0) w_.put(tile.lod);
    if (tile.classes) w_.put(classes_.number(tile.classes));
    if (tile.named_sizes) w_.put(named_sizes_.number(tile.named_sizes));
    path_ = tile.path.string(), name_ = tile.name, scene_ = tile.scene_from_tile, world_ = tile.world_from_tile;
  }

 private:
  ByteWriter& w_;
  Shared<Archive> archives_;
  Shared<DemRaster> rasters_;
  Shared<SourceEdits> edits_;
  Shared<SourceClasses> classes_;
  Shared<NamedVoxelSizes> named_sizes_;
  std::string path_, name_;  ///< path_, name_, scene_ and world_ are of the previous tile
  Affine<Scene, World> scene_;
  Affine<World, World> world_;
};

/// Reads a text, and parses it. Wrong members mean malformed bytes, not a wrong option.
template <class Parse>
auto get_parsed(ByteReader& r, const Parse& parse) {
  std::string text;
  r.get(text);
  try {
    return parse(text);
  } catch (const UsageError& e) {
    throw InputError(what, "edits", e.what());
  }
}

/// Reads what a scene .json states for a source, and its place in the file.
template <class Parse>
auto get_stated(ByteReader& r, const Parse& parse) {
  auto stated = get_parsed(r, parse);
  stated.file = get_path(r);
  r.get(stated.key);
  return std::make_shared<const decltype(stated)>(std::move(stated));
}

class TileReader {
 public:
  explicit TileReader(ByteReader& r) : r_(r) {}

  void get_shared() {
    get_all(r_, archives_, [this] { return std::make_shared<const Archive>(get_path(r_)); });
    get_all(r_, rasters_, [this] { return get_raster(r_); });
    get_all(r_, edits_, [this] {
      return std::make_shared<const SourceEdits>(get_parsed(
          r_, [](const std::string& text) { return source_edits_from_json("the edits of a source", text); }));
    });
    get_all(r_, classes_, [this] { return get_stated(r_, source_classes_from_json); });
    get_all(r_, named_sizes_, [this] { return get_stated(r_, named_voxel_sizes_from_json); });
  }

  TileRef get() {
    TileRef tile;
    std::uint8_t flags = 0;
    r_.get(tile.kind), r_.get(tile.gltf_up);
    r_.get(flags);
    if (flags > all_flags) refuse("tile.flags", "known flags only");
    get_next(r_, path_), get_next(r_, name_);
    r_.get(tile.bytes);
    get_next_place(r_, scene_);
    get_next_place(r_, world_);
    if (!scene_.is_finite()) refuse("tile.scene_from_tile", "a finite transform");
    if ((flags & has_range) != 0) r_.get(tile.range);
    if ((flags & has_archive) != 0) tile.archive = shared_part(archives_, "tile.archive", "the number of an archive");
    if ((flags & has_raster) != 0) tile.dem = get_dem(r_, rasters_);
    if ((flags & has_edits) != 0) tile.edits = shared_part(edits_, "tile.edits", "the number of a list of edits");
    if ((flags & has_lod) != 0) r_.get(tile.lod);
    if ((flags & has_classes) != 0)
      tile.classes = shared_part(classes_, "tile.classes", "the number of the classes of a source");
    if ((flags & has_named_sizes) != 0)
      tile.named_sizes = shared_part(named_sizes_, "tile.named_sizes", "the number of the voxel sizes of names");
    if (tile.lod > max_source_lod) refuse("tile.lod", "a level of a cell");
    if ((tile.kind == ContentKind::dem) != (tile.dem != nullptr))
      refuse("tile.raster", "a raster only for an elevation tile");
    tile.path = path_, tile.name = name_, tile.scene_from_tile = scene_, tile.world_from_tile = world_;
    return tile;
  }

 private:
  /// Returns the part with the number that is read.
  template <class Part>
  std::shared_ptr<const Part> shared_part(const std::vector<std::shared_ptr<const Part>>& parts, const char* key,
                                          const char* expected) {
    std::uint32_t number = 0;
    r_.get(number);
    if (number >= parts.size()) refuse(key, expected);
    return parts[number];
  }

  ByteReader& r_;
  std::vector<std::shared_ptr<const Archive>> archives_;
  std::vector<std::shared_ptr<const DemRaster>> rasters_;
  std::vector<std::shared_ptr<const SourceEdits>> edits_;
  std::vector<std::shared_ptr<const SourceClasses>> classes_;
  std::vector<std::shared_ptr<const NamedVoxelSizes>> named_sizes_;
  std::string path_, name_;
  Affine<Scene, World> scene_;
  Affine<World, World> world_;
};

Area with_crs_map(Area area) {
  if (!area.crs.empty()) area.crs_map = open_crs_map(area.crs);
  return area;
}

SkippedSource get_skipped(ByteReader& r) {
  SkippedSource skipped;
  r.get(skipped.name), r.get(skipped.reason);
  r.get(skipped.informative);
  r.get(skipped.points);
  return skipped;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const SceneSources& sources) {
  ByteWriter w;
  w.put(sources.root.string());
  put_optional(w, sources.origin);
  TileWriter tiles(w);
  tiles.put_shared(sources.tiles);
  w.put(std::uint64_t(sources.tiles.size()));
  for (const TileRef& tile : sources.tiles) tiles.put(tile);
  w.put(std::uint64_t(sources.skipped.size()));
  for (const SkippedSource& skipped : sources.skipped) {
    w.put(skipped.name), w.put(skipped.reason);
    w.put(std::uint8_t(skipped.informative)), w.put(skipped.points);
  }
  w.put(sources.notes);
  w.put(std::uint8_t(sources.area != nullptr));
  if (sources.area) put(w, *sources.area);
  w.put(sources.edits ? to_json(*sources.edits) : std::string());
  return w.take();
}

SceneSources sources_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, what);
  SceneSources sources;
  sources.root = get_path(r);
  get_optional(r, sources.origin);
  TileReader tiles(r);
  tiles.get_shared();
  get_all(r, sources.tiles, [&tiles] { return tiles.get(); });
  get_all(r, sources.skipped, [&r] { return get_skipped(r); });
  r.get(sources.notes);
  bool has_area = false;
  r.get(has_area);
  if (has_area) sources.area = std::make_shared<const Area>(with_crs_map(get_area(r)));
  sources.edits = get_parsed(r, [](const std::string& text) -> std::shared_ptr<const EditList> {
    return text.empty() ? nullptr : std::make_shared<const EditList>(edits_from_json("the scene's edits", text));
  });
  r.expect_end();
  return sources;
}

}  // namespace gigabake
