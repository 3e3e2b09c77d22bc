#include "format/source/raster/gdal/gdal_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cpl_minixml.h>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string_view>

#include "format/source/raster/dem_checks.h"
#include "format/source/raster/ellipsoid_heights.h"
#include "format/source/raster/gdal/gdal_open.h"
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
  if (has_nodata != 0) rule.nodata = {own};
  if (!o.nodata.empty()) rule.nodata = o.nodata;
  rule.scale = band.GetScale(), rule.offset = band.GetOffset(), rule.unit_m = height_scale_of(o, dataset);
  rule.geoid_offset_m = o.geoid_offset_m.value_or(0);
  rule.is_nodata_chosen = !o.nodata.empty();
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

/// Converts the heights of a window of a part. A height at a place that is not on the earth is unchanged.
/// Errors  InputError: the transformation does not cover a height.
void convert_to_ellipsoid(const EllipsoidHeights& heights, const DemTile& tile, const DemPart& part, const Window& w,
                          const Ground& ground, std::vector<double>& z) {
  const Grid grid{tile.raster->geotransform};
  std::vector<std::size_t> pixels;
  std::vector<double> x, y, height_m;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (std::isnan(z[i])) continue;
    const auto columns = std::size_t(w.columns);
    const auto [px, py] = grid.place(part.column + w.column + int(i % columns), part.row + w.row + int(i / columns));
    pixels.push_back(i), x.push_back(px), y.push_back(py), height_m.push_back(z[i]);
  }
  heights.convert(x, y, height_m);
  const std::vector<char> is_located = ground.locate(x, y);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (is_located[i] == 0) continue;
    if (std::isnan(height_m[i]))
      throw InputError(part.options.dem, "crs", heights.why_not_covered({x[i], y[i], x[i], y[i]}));
    z[pixels[i]] = height_m[i];
  }
}

/// Returns the heights of a window of one part; NaN for pixels without a value. Returns an empty list if no pixel has
/// a value.
std::vector<double> part_heights(const DemTile& tile, const DemPart& part, const Window& w, const Ground& ground,
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
  for (std::string& warning : take_heights(o.dem, height_rule(o, *dataset, ground.is_on_earth()), z))
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(std::move(warning));
  const EllipsoidHeights heights(o, *dataset, ground.is_on_earth());
  if (!heights.is_identity()) convert_to_ellipsoid(heights, tile, part, w, ground, z);
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
  if (o.nodata.empty() && has_nodata == 0) return false;
  if (std::isnan(value)) return true;
  return o.nodata.empty() ? value == own : std::find(o.nodata.begin(), o.nodata.end(), value) != o.nodata.end();
}

bool is_without_data(GDALRasterBand& band, int column, int row, int columns, int rows) {
  return (band.GetDataCoverageStatus(column, row, columns, rows, 0, nullptr) & GDAL_DATA_COVERAGE_STATUS_DATA) == 0;
}

/// One raster of a mosaic. A rectangle has left, top, width and height in pixels.
struct MosaicSource {
  std::filesystem::path file;
  int band = 1;
  std::array<double, 4> from{}, to{};  ///< rectangles in the source and in the mosaic
  std::vector<double> holes = {};      ///< numbers that are no heights
  bool is_changed = false;             ///< the mosaic converts the numbers of the source
};

std::array<double, 4> rectangle_of(const CPLXMLNode* node, const char* name) {
  std::array<double, 4> out{};
  const char* const keys[] = {"xOff", "yOff", "xSize", "ySize"};
  for (std::size_t i = 0; i < 4; ++i)
    out[i] = CPLAtof(CPLGetXMLValue(node, (std::string(name) + "." + keys[i]).c_str(), "0"));
  return out;
}

std::optional<MosaicSource> source_of(const std::filesystem::path& vrt, const char* text) {
  const std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)> xml(CPLParseXMLString(text), &CPLDestroyXMLNode);
  if (!xml) return std::nullopt;
  MosaicSource out;
  out.file = vrt.parent_path() / CPLGetXMLValue(xml.get(), "SourceFilename", "");
  const std::string band = CPLGetXMLValue(xml.get(), "SourceBand", "1");
  out.band = std::atoi(band.c_str());
  if (out.band < 1) return std::nullopt;  // a mask
  out.from = rectangle_of(xml.get(), "SrcRect"), out.to = rectangle_of(xml.get(), "DstRect");
  for (const auto& rectangle : {out.from, out.to})
    if (!(rectangle[2] > 0 && rectangle[3] > 0)) return std::nullopt;
  if (const char* nodata = CPLGetXMLValue(xml.get(), "NODATA", nullptr)) out.holes.push_back(CPLAtof(nodata));
  for (const char* name : {"ScaleOffset", "ScaleRatio", "LUT", "UseMaskBand", "ColorTableComponent"})
    out.is_changed |= CPLGetXMLNode(xml.get(), name) != nullptr;
  return out;
}

/// Pixels around a window that bilinear and other filters read.
constexpr double filter_pixels = 4;

struct IndexRange {
  int begin = 0, end = 0;
};

/// Converts a range of pixels of the mosaic into pixels of the source, along one axis.
IndexRange source_span(const MosaicSource& s, std::size_t axis, int begin, int size, int source_size) {
  const double scale = s.from[axis + 2] / s.to[axis + 2];
  const double low = std::max(double(begin), s.to[axis]),
               high = std::min(double(begin) + size, s.to[axis] + s.to[axis + 2]);
  if (!(high > low)) return {};
  const double margin = scale == 1 ? 1 : filter_pixels * std::max(scale, 1.0);
  const double first = s.from[axis] + (low - s.to[axis]) * scale - margin;
  const double last = s.from[axis] + (high - s.to[axis]) * scale + margin;
  return {int(std::clamp(std::floor(first), 0.0, double(source_size))),
          int(std::clamp(std::ceil(last), 0.0, double(source_size)))};
}

/// Returns the sources of a mosaic. Returns an empty list if `vrt` is no mosaic, a source is not supported, or pixels
/// without a source are not holes.
std::vector<MosaicSource> mosaic_sources(const DemOptions& options, GDALDataset& vrt) {
  GDALRasterBand& band = *vrt.GetRasterBand(1);
  if (!EQUAL(vrt.GetDriver() != nullptr ? vrt.GetDriver()->GetDescription() : "", "VRT")) return {};
  if (validity_band(vrt) != nullptr || !is_hole(options, band, left_out_value(band))) return {};
  std::vector<MosaicSource> out;
  char** list = band.GetMetadata("vrt_sources");
  for (char** item = list; item != nullptr && *item != nullptr; ++item) {
    const char* text = std::strchr(*item, '=');
    const auto source = text != nullptr ? source_of(options.dem, text + 1) : std::nullopt;
    if (!source) return {};
    out.push_back(*source);
    out.back().holes.push_back(left_out_value(band));
    out.back().holes.insert(out.back().holes.end(), options.nodata.begin(), options.nodata.end());
  }
  return out;
}

/// A source of a mosaic, opened to find out which windows of the mosaic it leaves empty.
class SourceCoverage {
 public:
  explicit SourceCoverage(const MosaicSource& source) : source_(source), raster_(borrow_raster(source.file, "dem")) {
    if (source.is_changed || source.band > raster_->GetRasterCount()) return;
    const double value = left_out_value(*raster_->GetRasterBand(source.band));
    is_hole_ = std::isnan(value) || std::find(source.holes.begin(), source.holes.end(), value) != source.holes.end();
  }

  /// Returns true if the source does not overlap the window of the mosaic, or omits all blocks in the window.
  bool is_empty(int left, int top, int columns, int rows) const {
    const IndexRange x = source_span(source_, 0, left, columns, raster_->GetRasterXSize());
    const IndexRange y = source_span(source_, 1, top, rows, raster_->GetRasterYSize());
    if (x.begin >= x.end || y.begin >= y.end) return true;
    return is_hole_ &&
           is_without_data(*raster_->GetRasterBand(source_.band), x.begin, y.begin, x.end - x.begin, y.end - y.begin);
  }

 private:
  const MosaicSource& source_;
  BorrowedRaster raster_;
  bool is_hole_ = false;  ///< an omitted block is a hole
};

/// A window of pixels of a part. `right` and `bottom` are exclusive.
struct PixelWindow {
  int left, top, right, bottom;
};

class FilledTiles {
 public:
  FilledTiles(const DemRaster& raster, int edge)
      : edge_(edge),
        columns_((raster.columns - 2) / edge + 1),
        rows_((raster.rows - 2) / edge + 1),
        filled_(std::size_t(columns_) * std::size_t(rows_), 0) {}

  void add(const DemPart& part) {
    BorrowedRaster dataset = borrow_raster(part.options.dem, "dem");
    const std::vector<MosaicSource> sources = mosaic_sources(part.options, *dataset);
    if (sources.empty())
      return add_windows(part, {0, 0, part.columns, part.rows}, [&](int left, int top, int columns, int rows) {
        return is_known_empty(part.options, *dataset, left, top, columns, rows);
      });
    dataset.reset();  // a thread may borrow only one raster at a time
    for (const MosaicSource& source : sources) {
      const SourceCoverage coverage(source);
      add_windows(part, window_of(source, part), [&](int left, int top, int columns, int rows) {
        return coverage.is_empty(left, top, columns, rows);
      });
    }
  }

  std::vector<char> take() { return std::move(filled_); }

 private:
  static PixelWindow window_of(const MosaicSource& source, const DemPart& part) {
    const auto pixel = [](double at, int size) { return int(std::clamp(at, 0.0, double(size))); };
    return {pixel(std::floor(source.to[0]), part.columns), pixel(std::floor(source.to[1]), part.rows),
            pixel(std::ceil(source.to[0] + source.to[2]), part.columns),
            pixel(std::ceil(source.to[1] + source.to[3]), part.rows)};
  }

  /// Marks the tiles that overlap a window of a part as filled, unless is_empty() returns true. Calls is_empty() per
  /// tile that is not filled yet, with the window of the tile in pixels of the part.
  void add_windows(const DemPart& part, const PixelWindow& within,
                   const std::function<bool(int, int, int, int)>& is_empty) {
    const int last_row = std::min(rows_ - 1, (part.row + within.bottom - 1) / edge_);
    const int last_column = std::min(columns_ - 1, (part.column + within.right - 1) / edge_);
    for (int row = std::max(0, part.row + within.top - 1) / edge_; row <= last_row; ++row)
      for (int column = std::max(0, part.column + within.left - 1) / edge_; column <= last_column; ++column) {
        char& is_filled = filled_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
        const int left = std::max(column * edge_, part.column), top = std::max(row * edge_, part.row);
        const int right = std::min(column * edge_ + edge_ + 1, part.column + part.columns);
        const int bottom = std::min(row * edge_ + edge_ + 1, part.row + part.rows);
        if (is_filled == 0 && right > left && bottom > top)
          is_filled = !is_empty(left - part.column, top - part.row, right - left, bottom - top);
      }
  }

  int edge_, columns_, rows_;
  std::vector<char> filled_;
};

}  // namespace

bool is_known_empty(const DemOptions& options, GDALDataset& dataset, int column, int row, int columns, int rows) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  if (!is_without_data(band, column, row, columns, rows)) return false;
  if (is_hole(options, band, left_out_value(band))) return true;
  GDALRasterBand* validity = validity_band(dataset);  // omitted blocks of a mask are read as 0, which means no value
  return validity != nullptr && is_without_data(*validity, column, row, columns, rows);
}

double fraction_left_out(const DemOptions& options, GDALDataset& dataset) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  if (is_hole(options, band, left_out_value(band)) || validity_band(dataset) != nullptr) return 0;
  double percent = 100;
  band.GetDataCoverageStatus(0, 0, band.GetXSize(), band.GetYSize(), 0, &percent);
  return percent < 0 ? 0 : 1 - percent / 100;
}

std::vector<char> filled_tiles(const DemRaster& raster, int edge) {
  FilledTiles tiles(raster, edge);
  for (const DemPart& part : raster.parts) tiles.add(part);
  return tiles.take();
}

std::vector<double> read_heights(const DemTile& tile, const Ground& ground, std::vector<std::string>& warnings) {
  const auto width = std::size_t(tile.columns + 1), height = std::size_t(tile.rows + 1);
  std::vector<double> out(width * height, std::numeric_limits<double>::quiet_NaN());
  for (const DemPart& part : tile.raster->parts) {
    const Window w = window_of(tile, part);
    if (w.is_empty()) continue;
    const std::vector<double> z = part_heights(tile, part, w, ground, warnings);
    const auto first_column = std::size_t(part.column + w.column - tile.column);
    const auto first_row = std::size_t(part.row + w.row - tile.row);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!std::isnan(z[i]))
        out[(first_row + i / std::size_t(w.columns)) * width + first_column + i % std::size_t(w.columns)] = z[i];
  }
  return out;
}

}  // namespace gigabake
