#include "format/job/raster_bytes.h"

#include <string>

#include "core/base/error.h"

namespace gigabake::source_bytes {
namespace {

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

/// Returns whether `cells` cells from `first` on lie within a row of `pixels` pixels.
bool is_inside(std::int32_t first, std::int32_t cells, int pixels) {
  return first >= 0 && cells >= 1 && first < pixels && cells < pixels - first;
}

}  // namespace

void refuse(const char* key, const char* expected) { throw InputError(what, key, std::string("expected ") + expected); }

std::filesystem::path get_path(ByteReader& r) {
  std::string text;
  r.get(text);
  return text;
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

}  // namespace gigabake::source_bytes
