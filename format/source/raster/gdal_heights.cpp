#include "format/source/raster/gdal_heights.h"

#include <limits>
#include <string_view>

#include "format/source/raster/dem_checks.h"
#include "format/source/raster/gdal_open.h"
#include "format/source/raster/height_values.h"

namespace gigabake {
namespace {

/// The pixels of a part that a tile needs.
struct Window {
  int column = 0, row = 0, columns = 0, rows = 0;
  bool is_empty() const { return columns <= 0 || rows <= 0; }
};

/// Returns the intersection of the vertices of a tile with a part, in the pixels of the part.
Window window_of(const DemTile& tile, const DemPart& part) {
  const auto range = [](int first, int count, int part_first, int part_count) {
    const int begin = std::max(first, part_first), end = std::min(first + count, part_first + part_count);
    return std::pair(begin - part_first, end - begin);
  };
  const auto [column, columns] = range(tile.column, tile.columns + 1, part.column, part.columns);
  const auto [row, rows] = range(tile.row, tile.rows + 1, part.row, part.rows);
  return {column, row, columns, rows};
}

/// Returns a hint to append to an error message. GDAL before 3.9 parses rows of "nan" after the header of an ASCII grid
/// as part of the header.
const char* remedy_of(GDALRasterBand& band) {
  GDALDriver* driver = band.GetDataset() != nullptr ? band.GetDataset()->GetDriver() : nullptr;
  const bool is_text = driver != nullptr && std::string_view(driver->GetDescription()) == "AAIGrid";
  return is_text ? "; if its first values are nan, write them as a number that NODATA_value names" : "";
}

std::vector<double> read_band(const DemOptions& o, const Window& w, GDALRasterBand& band) {
  std::vector<double> values(std::size_t(w.columns) * std::size_t(w.rows));
  if (band.RasterIO(GF_Read, w.column, w.row, w.columns, w.rows, values.data(), w.columns, w.rows, GDT_Float64, 0, 0) !=
      CE_None)
    throw InputError(o.dem, "dem", "cannot be read" + QuietErrors::last() + remedy_of(band));
  return values;
}

HeightRule height_rule(const DemOptions& o, GDALDataset& dataset, bool is_on_earth) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  HeightRule rule;
  int has_nodata = 0;
  const double own = band.GetNoDataValue(&has_nodata);
  if (has_nodata != 0) rule.nodata = own;
  if (o.nodata) rule.nodata = *o.nodata;
  rule.scale = band.GetScale(), rule.offset = band.GetOffset(), rule.unit_m = height_scale_of(o, dataset);
  rule.geoid_offset_m = o.geoid_offset_m.value_or(0);
  rule.is_nodata_chosen = o.nodata.has_value();
  rule.is_unit_chosen = o.height_scale.has_value() || !is_on_earth;
  return rule;
}

/// Restores negative values of signed bytes, which GDAL before 3.7 reads as unsigned.
void restore_signs(GDALRasterBand& band, std::vector<double>& values) {
  const char* kind = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  if (band.GetRasterDataType() != GDT_Byte || kind == nullptr || !EQUAL(kind, "SIGNEDBYTE")) return;
  for (double& v : values)
    if (v > 127) v -= 256;
}

/// Returns the heights of a window of one part; NaN for pixels without a value. Returns an empty list if no pixel has
/// a value.
std::vector<double> part_heights(const DemPart& part, const Window& w, bool is_on_earth,
                                 std::vector<std::string>& warnings) {
  const DemOptions& o = part.options;
  const BorrowedRaster dataset = borrow_raster(o.dem, "dem");
  if (dataset->GetRasterXSize() != part.columns || dataset->GetRasterYSize() != part.rows)
    throw InputError(o.dem, "dem", "changed while the bake ran; bake again");
  if (is_known_empty(o, *dataset, w.column, w.row, w.columns, w.rows)) return {};
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  std::vector<double> z = read_band(o, w, band);
  restore_signs(band, z);
  if (GDALRasterBand* validity = validity_band(*dataset)) {
    const std::vector<double> is_valid = read_band(o, w, *validity);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (is_valid[i] == 0) z[i] = std::numeric_limits<double>::quiet_NaN();
  }
  for (std::string& warning : take_heights(o.dem, height_rule(o, *dataset, is_on_earth), z))
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(std::move(warning));
  return z;
}

/// Returns the value that GDAL returns for omitted blocks.
double left_out_value(GDALRasterBand& band) {
  int has_nodata = 0;
  const double nodata = band.GetNoDataValue(&has_nodata);
  return has_nodata != 0 ? nodata : 0;
}

/// Returns whether a number is declared to mark missing heights.
bool is_hole(const DemOptions& o, GDALRasterBand& band, double value) {
  int has_nodata = 0;
  const double own = band.GetNoDataValue(&has_nodata);
  if (!o.nodata && has_nodata == 0) return false;
  const double nodata = o.nodata.value_or(own);
  return std::isnan(value) || value == nodata;
}

bool is_without_data(GDALRasterBand& band, int column, int row, int columns, int rows) {
  return (band.GetDataCoverageStatus(column, row, columns, rows, 0, nullptr) & GDAL_DATA_COVERAGE_STATUS_DATA) == 0;
}

}  // namespace

bool is_known_empty(const DemOptions& options, GDALDataset& dataset, int column, int row, int columns, int rows) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  if (!is_without_data(band, column, row, columns, rows)) return false;
  if (is_hole(options, band, left_out_value(band))) return true;
  GDALRasterBand* validity = validity_band(dataset);  // omitted blocks of a mask are read as 0: no value
  return validity != nullptr && is_without_data(*validity, column, row, columns, rows);
}

double fraction_left_out(const DemOptions& options, GDALDataset& dataset) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  if (is_hole(options, band, left_out_value(band)) || validity_band(dataset) != nullptr) return 0;
  double percent = 100;
  band.GetDataCoverageStatus(0, 0, band.GetXSize(), band.GetYSize(), 0, &percent);
  return percent < 0 ? 0 : 1 - percent / 100;
}

std::vector<double> read_heights(const DemTile& tile, bool is_on_earth, std::vector<std::string>& warnings) {
  const auto width = std::size_t(tile.columns + 1), height = std::size_t(tile.rows + 1);
  std::vector<double> out(width * height, std::numeric_limits<double>::quiet_NaN());
  for (const DemPart& part : tile.raster->parts) {
    const Window w = window_of(tile, part);
    if (w.is_empty()) continue;
    const std::vector<double> z = part_heights(part, w, is_on_earth, warnings);
    const auto first_column = std::size_t(part.column + w.column - tile.column);
    const auto first_row = std::size_t(part.row + w.row - tile.row);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!std::isnan(z[i]))
        out[(first_row + i / std::size_t(w.columns)) * width + first_column + i % std::size_t(w.columns)] = z[i];
  }
  return out;
}

}  // namespace gigabake
