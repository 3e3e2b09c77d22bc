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
#include "format/source/classes/source_classes.h"
#include "format/source/raster/crs_map.h"
#include "format/source/raster/dem.h"
#include "format/source/tiles/archive.h"

namespace gigabake {
namespace {

constexpr const char* what = "sources";
/// Max length of the prefix that a tile's name shares with the previous one. Without this bound, malformed bytes could
/// request any amount of memory.
constexpr std::size_t max_shared_prefix = 4096;
/// The coarsest level of the largest cell.
constexpr int max_source_lod = 10;

/// The parts that a tile has in addition to its placement.
enum TileFlag : std::uint8_t {
  has_range = 1,
  has_archive = 2,
  has_raster = 4,
  has_edits = 8,
  has_lod = 16,
  has_classes = 32,
  all_flags = 63
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

template <class Value>
void put_optional(ByteWriter& w, const std::optional<Value>& value) {
  w.put(std::uint8_t(value.has_value()));
  if (value) w.put(*value);
}

[[noreturn]] void refuse(const char* key, const char* expected) {
  throw InputError(what, key, std::string("expected ") + expected);
}

template <class Value>
void get_optional(ByteReader& r, std::optional<Value>& value) {
  bool is_there = false;
  r.get(is_there);
  value.reset();
  if (is_there) r.get(value.emplace());
}

std::filesystem::path get_path(ByteReader& r) {
  std::string text;
  r.get(text);
  return text;
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

void put_part(ByteWriter& w, const DemPart& part) {
  const DemOptions& o = part.options;
  w.put(o.dem.string()), w.put(o.ortho.string()), w.put(o.crs), w.put(o.ortho_crs);
  w.put(o.nodata), put_optional(w, o.height_scale), put_optional(w, o.geoid_offset_m);
  for (const int number : {o.tile_cells, part.column, part.row, part.columns, part.rows}) w.put(std::int32_t(number));
  w.put(std::uint64_t(part.grids.size()));
  for (const std::filesystem::path& grid : part.grids) w.put(grid.string());
}

DemPart get_part(ByteReader& r) {
  DemPart part;
  DemOptions& o = part.options;
  o.dem = get_path(r), o.ortho = get_path(r);
  r.get(o.crs), r.get(o.ortho_crs);
  r.get(o.nodata), get_optional(r, o.height_scale), get_optional(r, o.geoid_offset_m);
  for (int* const number : {&o.tile_cells, &part.column, &part.row, &part.columns, &part.rows}) {
    std::int32_t value = 0;
    r.get(value);
    *number = value;
  }
  std::uint64_t grids = 0;
  for (r.get(grids); grids > 0; --grids) part.grids.push_back(get_path(r));
  if (o.tile_cells < 1 || part.columns < 2 || part.rows < 2)
    refuse("raster", "at least one cell per tile and 2 × 2 pixels");
  return part;
}

void put_raster(ByteWriter& w, const DemRaster& raster) {
  w.put(std::uint64_t(raster.parts.size()));
  for (const DemPart& part : raster.parts) put_part(w, part);
  for (const int number : {raster.columns, raster.rows, raster.texels_per_cell}) w.put(std::int32_t(number));
  w.put(raster.geotransform), w.put(raster.origin), w.put(std::uint8_t(raster.is_on_earth));
}

std::shared_ptr<const DemRaster> get_raster(ByteReader& r) {
  auto raster = std::make_shared<DemRaster>();
  std::uint64_t parts = 0;
  for (r.get(parts); parts > 0; --parts) raster->parts.push_back(get_part(r));
  std::int32_t columns = 0, rows = 0, texels = 0;
  std::uint8_t is_on_earth = 0;
  r.get(columns), r.get(rows), r.get(texels);
  r.get(raster->geotransform), r.get(raster->origin), r.get(is_on_earth);
  if (raster->parts.empty() || columns < 2 || rows < 2 || texels < 1)
    refuse("raster", "at least one part and 2 × 2 pixels");
  for (const DemPart& part : raster->parts)
    if (part.column < 0 || part.row < 0 || part.columns > columns - part.column || part.rows > rows - part.row)
      refuse("raster", "parts inside the raster");
  raster->columns = columns, raster->rows = rows, raster->texels_per_cell = texels;
  raster->is_on_earth = is_on_earth != 0;
  return raster;
}

void put_dem(ByteWriter& w, const DemTile& dem, std::uint32_t raster) {
  w.put(raster);
  for (const int number : {dem.column, dem.row, dem.columns, dem.rows}) w.put(std::int32_t(number));
  w.put(dem.offset_m);
}

/// Returns whether `cells` cells from `first` on lie within a row of `pixels` pixels.
bool is_inside(std::int32_t first, std::int32_t cells, int pixels) {
  return first >= 0 && cells >= 1 && first < pixels && cells < pixels - first;
}

std::shared_ptr<const DemTile> get_dem(ByteReader& r, const std::vector<std::shared_ptr<const DemRaster>>& rasters) {
  std::uint32_t number = 0;
  std::int32_t column = 0, row = 0, columns = 0, rows = 0;
  auto dem = std::make_shared<DemTile>();
  r.get(number), r.get(column), r.get(row), r.get(columns), r.get(rows), r.get(dem->offset_m);
  if (number >= rasters.size()) refuse("tile.raster", "the number of a raster");
  const DemRaster& raster = *rasters[number];
  if (!is_inside(column, columns, raster.columns) || !is_inside(row, rows, raster.rows))
    refuse("tile.raster", "cells inside the raster");
  dem->raster = rasters[number];
  dem->column = column, dem->row = row, dem->columns = columns, dem->rows = rows;
  return dem;
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
    }
    w_.put(std::uint64_t(archives_.parts().size()));
    for (const auto& archive : archives_.parts()) w_.put(archive->file().string());
    w_.put(std::uint64_t(rasters_.parts().size()));
    for (const auto& raster : rasters_.parts()) put_raster(w_, *raster);
    w_.put(std::uint64_t(edits_.parts().size()));
    for (const auto& edits : edits_.parts()) w_.put(to_json(*edits));
    w_.put(std::uint64_t(classes_.parts().size()));
    for (const auto& classes : classes_.parts())
      w_.put(to_json(*classes)), w_.put(classes->file.string()), w_.put(classes->key);
  }

  void put(const TileRef& tile) {
    w_.put(std::uint8_t(tile.kind)), w_.put(std::uint8_t(tile.gltf_up));
    w_.put(std::uint8_t((tile.range == ByteRange{} ? 0 : has_range) | (tile.archive ? has_archive : 0) |
                        (tile.dem ? has_raster : 0) | (tile.edits ? has_edits : 0) | (tile.lod != 0 ? has_lod : 0) |
                        (tile.classes ? has_classes : 0)));
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
    path_ = tile.path.string(), name_ = tile.name, scene_ = tile.scene_from_tile, world_ = tile.world_from_tile;
  }

 private:
  ByteWriter& w_;
  Shared<Archive> archives_;
  Shared<DemRaster> rasters_;
  Shared<SourceEdits> edits_;
  Shared<SourceClasses> classes_;
  std::string path_, name_;  ///< path_, name_, scene_ and world_ are of the previous tile
  Affine<Scene, World> scene_;
  Affine<World, World> world_;
};

/// Returns the edits that `read` reads. Wrong edits mean malformed bytes, not a wrong option.
template <class Read>
auto edits_in_bytes(const Read& read) {
  try {
    return read();
  } catch (const UsageError& e) {
    throw InputError(what, "edits", e.what());
  }
}

class TileReader {
 public:
  explicit TileReader(ByteReader& r) : r_(r) {}

  void get_shared() {
    std::uint64_t archives = 0, rasters = 0;
    for (r_.get(archives); archives > 0; --archives) archives_.push_back(std::make_shared<const Archive>(get_path(r_)));
    for (r_.get(rasters); rasters > 0; --rasters) rasters_.push_back(get_raster(r_));
    std::uint64_t edits = 0;
    std::string text;
    for (r_.get(edits); edits > 0; --edits) {
      r_.get(text);
      edits_.push_back(std::make_shared<const SourceEdits>(
          edits_in_bytes([&] { return source_edits_from_json("the edits of a source", text); })));
    }
    std::uint64_t classes = 0;
    for (r_.get(classes); classes > 0; --classes) {
      r_.get(text);
      auto read = std::make_shared<SourceClasses>(edits_in_bytes([&] { return source_classes_from_json(text); }));
      read->file = get_path(r_);
      r_.get(read->key);
      classes_.push_back(std::move(read));
    }
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
  std::uint64_t count = 0;
  // Does not reserve memory, because the count is not trusted.
  for (r.get(count); count > 0; --count) sources.tiles.push_back(tiles.get());
  for (r.get(count); count > 0; --count) sources.skipped.push_back(get_skipped(r));
  r.get(sources.notes);
  bool has_area = false;
  r.get(has_area);
  if (has_area) sources.area = std::make_shared<const Area>(with_crs_map(get_area(r)));
  std::string edits;
  r.get(edits);
  if (!edits.empty())
    sources.edits =
        std::make_shared<const EditList>(edits_in_bytes([&] { return edits_from_json("the scene's edits", edits); }));
  r.expect_end();
  return sources;
}

}  // namespace gigabake
