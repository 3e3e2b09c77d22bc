#include "format/source/raster/gdal/gdal_head.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string_view>

#include "core/base/error.h"
#include "format/source/raster/dem_checks.h"
#include "format/source/raster/ellipsoid_heights.h"
#include "format/source/raster/gdal/gdal_heights.h"
#include "format/source/raster/gdal/gdal_open.h"
#include "format/source/raster/raster_claims.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// The range of plausible pixel sizes on the ground. Other sizes indicate that degrees and metres were confused.
constexpr double min_pixel_m = 1e-3, max_pixel_m = 2e5;

Grid grid_of(const Path& file, GDALDataset& dataset) {
  Grid grid;
  if (dataset.GetGeoTransform(grid.g.data()) != CE_None || !std::isnormal(grid.determinant()))
    throw InputError(file, "dem",
                     "the raster does not state the position of its pixels; give it a geotransform or a world file");
  return grid;
}

[[noreturn]] void refuse_place(const DemOptions& o, const Ground& ground) {
  throw InputError(o.dem, "crs",
                   "the raster's coordinates are not on the earth in its coordinate system (" + ground.name() +
                       "); set the right one in the scene file");
}

/// Throws InputError if an ASCII grid is too short for the declared number of values.
void expect_whole_text(const DemOptions& o, GDALDataset& dataset) {
  if (std::string_view(dataset.GetDriver()->GetDescription()) != "AAIGrid") return;
  const std::uint64_t columns = std::uint64_t(dataset.GetRasterXSize()), rows = std::uint64_t(dataset.GetRasterYSize());
  const std::uint64_t bytes = std::filesystem::file_size(o.dem);
  if (columns * rows > bytes)
    throw InputError(o.dem, "dem",
                     "the grid states " + std::to_string(columns) + " × " + std::to_string(rows) +
                         " values, more than its " + std::to_string(bytes) + " bytes can hold");
}

/// Rejects a GeoTIFF with a false header: its size is stated as far more than the file can hold. Blocks that a sparse
/// file leaves out need only their entry in the index.
/// Cost    Reads the index of blocks.
void expect_whole_tiff(const DemOptions& o, GDALDataset& dataset) {
  if (std::string_view(dataset.GetDriver()->GetDescription()) != "GTiff") return;
  constexpr double min_index_bytes = 6;  // an offset of 4 bytes and a size of 2 bytes per block
  constexpr double min_fraction = 0.1;   // tiles of a file that is cut off are reported when they are read
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  int width = 1, height = 1;
  band.GetBlockSize(&width, &height);
  const double blocks = std::ceil(double(band.GetXSize()) / width) * std::ceil(double(band.GetYSize()) / height);
  double bytes = blocks > 1 ? blocks * min_index_bytes : 0;
  const bool is_plain = dataset.GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE") == nullptr &&
                        band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE") == nullptr;
  double percent = 0;
  if (is_plain) band.GetDataCoverageStatus(0, 0, band.GetXSize(), band.GetYSize(), 0, &percent);
  if (percent > 0)
    bytes += percent / 100 * band.GetXSize() * band.GetYSize() * GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  const std::uint64_t own_bytes = std::filesystem::file_size(o.dem);
  // GDAL divides strips into rows that have no entry in the index, but never tiles.
  const double index_bytes = width < band.GetXSize() ? blocks * min_index_bytes : 0;
  if (double(own_bytes) < std::max(min_fraction * bytes, index_bytes))
    throw InputError(o.dem, "dem",
                     "its header states " + std::to_string(band.GetXSize()) + " × " + std::to_string(band.GetYSize()) +
                         " values, more than its " + std::to_string(own_bytes) + " bytes can hold");
}

/// Returns the bounds of sample points of a raster.
std::array<double, 4> bounds_of(const DemPart& part, const Grid& grid, const Ground& ground) {
  std::vector<double> x, y;
  for (const auto& [c, r] : sample_points(0, 0, part.columns - 1, part.rows - 1)) {
    const auto [px, py] = grid.place(c, r);
    x.push_back(px), y.push_back(py);
  }
  const std::vector<char> is_located = ground.locate(x, y);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 4> out{infinity, infinity, -infinity, -infinity};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_located[i] == 0) continue;
    out = {std::min(out[0], x[i]), std::min(out[1], y[i]), std::max(out[2], x[i]), std::max(out[3], y[i])};
  }
  return out;
}

/// Sets the note and the grids of a part. Checks that the transformation of heights covers a sample point.
/// Errors  InputError: it covers none. Reading a tile reports single heights that are not covered.
void set_heights(const EllipsoidHeights& heights, RasterHead& head) {
  DemPart& part = head.part;
  part.heights_note = heights_note(part.options, heights, head.bounds);
  if (heights.is_identity()) return;
  if (const auto used = heights.transformation(head.bounds)) part.grids = used->grids;
  std::vector<double> x, y;
  for (const auto& [c, r] : sample_points(0, 0, part.columns - 1, part.rows - 1)) {
    const auto [px, py] = head.grid.place(c, r);
    x.push_back(px), y.push_back(py);
  }
  std::vector<double> height_m(x.size(), 0);
  heights.convert(std::move(x), std::move(y), height_m);
  if (!std::all_of(height_m.begin(), height_m.end(), [](double h) { return std::isnan(h); })) return;
  throw InputError(part.options.dem, "crs", heights.why_not_covered(head.bounds));
}

}  // namespace

std::string short_number(double v) {
  std::ostringstream text;
  text << v;
  return text.str();
}

std::vector<std::pair<double, double>> sample_points(double column, double row, double columns, double rows) {
  constexpr int steps = 6;
  std::vector<std::pair<double, double>> out{{column + columns / 2, row + rows / 2}};
  for (int r = 0; r <= steps; ++r)
    for (int c = 0; c <= steps; ++c) out.emplace_back(column + columns * c / steps, row + rows * r / steps);
  return out;
}

LocatedPixel checked_pixel(const DemPart& part, const Grid& grid, const Ground& ground) {
  for (const auto& [c, r] : sample_points(part.column, part.row, part.columns - 1, part.rows - 1)) {
    std::vector<double> x, y;
    for (const auto& [dc, dr] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1)}) {
      const auto [px, py] = grid.place(c + dc, r + dr);
      x.push_back(px), y.push_back(py);
    }
    const std::vector<char> is_located = ground.locate(x, y);
    if (std::count(is_located.begin(), is_located.end(), 0) != 0) continue;
    LocatedPixel out{ground.origin(x[0], y[0]), 1};
    const Ground::Frame frame(ground, out.origin);
    for (const std::size_t i : {1, 2}) {
      const Point<Scene> p = frame(x[i], y[i], 0);
      const double pixel_m = std::hypot(p.x, p.y, p.z);
      if (!(pixel_m >= min_pixel_m && pixel_m <= max_pixel_m))
        throw InputError(part.options.dem, "crs",
                         "a pixel would be " + short_number(pixel_m) + " m wide in the raster's coordinate system (" +
                             ground.name() + "); set the right one in the scene file");
      out.size_m *= std::sqrt(pixel_m);
    }
    return out;
  }
  refuse_place(part.options, ground);
}

RasterHead head_of(const DemOptions& options, bool is_local) {
  RasterHead head;
  const BorrowedRaster dataset = borrow_raster(options.dem, "dem");
  DemPart& part = head.part;
  part.options = options;
  part.columns = dataset->GetRasterXSize(), part.rows = dataset->GetRasterYSize();
  if (part.columns < 2 || part.rows < 2)
    throw InputError(options.dem, "dem", "expected at least 2 × 2 pixels, which are the terrain's vertices");
  expect_whole_text(options, *dataset);
  expect_whole_tiff(options, *dataset);
  claim_tile(options, *dataset);
  head.grid = grid_of(options.dem, *dataset);
  const Ground ground(options, *dataset);
  if (!ground.is_on_earth() && !is_local) throw InputError(options.dem, "crs", ground.why_not_on_earth());
  head.pixel_m = checked_pixel(part, head.grid, ground).size_m;
  head.bounds = bounds_of(part, head.grid, ground);
  head.crs = crs_of(options, *dataset);
  part.warnings = check_dem(options, *dataset);
  if (ground.is_on_earth()) set_heights(EllipsoidHeights(options, *dataset, true, head.bounds), head);
  const double left_out = fraction_left_out(options, *dataset);
  if (left_out > 0)
    part.warnings.push_back("the file leaves out " + short_number(std::ceil(left_out * 1000) / 10) +
                            " % of its blocks, which are taken as heights of 0; set \"nodata\": 0 in a scene .json if "
                            "they are holes");
  return head;
}

}  // namespace gigabake
