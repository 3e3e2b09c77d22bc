/// What the parts that GDAL reads share: datasets, grids, coordinate systems.
#pragma once

#include <algorithm>
#include <cmath>
#include <cpl_error.h>
#include <cstring>
#include <filesystem>
#include <gdal_priv.h>
#include <memory>
#include <ogr_spatialref.h>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include "format/source/raster/dem.h"
#include "lattice/error.h"

namespace gigabake {

/// GDAL prints errors unless told otherwise; the last one is asked for instead. What GDAL calls fatal is that memory
/// ended; it would abort next.
struct QuietErrors {
  QuietErrors() { CPLPushErrorHandler(end_where_fatal), CPLErrorReset(); }
  ~QuietErrors() { CPLPopErrorHandler(); }
  static std::string last() {
    std::string text = CPLGetLastErrorMsg();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "" : ": " + text;
  }

 private:
  static void CPL_STDCALL end_where_fatal(CPLErr kind, CPLErrorNum, const char*) {
    if (kind != CE_Fatal) return;
    for (const char* part : {"gigabake: ", not_enough_memory, "\n"})
      if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
    ::_exit(1);
  }
};

struct CloseDataset {
  void operator()(GDALDataset* d) const { GDALClose(d); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

/// Formats that name no other files but those beside them. Errors  InputError(file, key).
Dataset open_raster(const std::filesystem::path& file, const char* key);

struct Grid {
  double g[6] = {0, 1, 0, 0, 0, 1};
  /// Of the pixel's centre.
  std::pair<double, double> place(double column, double row) const {
    return {g[0] + g[1] * (column + 0.5) + g[2] * (row + 0.5), g[3] + g[4] * (column + 0.5) + g[5] * (row + 0.5)};
  }
  double determinant() const { return g[1] * g[5] - g[2] * g[4]; }
};

/// The raster's own where it names no files, else nothing.
const OGRSpatialReference* plain_crs_of(GDALDataset& dataset);

std::string wkt_of(const OGRSpatialReference& crs);

/// The raster's own or that of the options. Errors  InputError: neither is there, or known.
OGRSpatialReference whole_crs_of(const DemOptions& options, GDALDataset& dataset);

/// Likewise, without its vertical part.
OGRSpatialReference crs_of(const DemOptions& options, GDALDataset& dataset);

/// From the raster's coordinates to the earth.
class EarthMap {
 public:
  EarthMap(const DemOptions& options, GDALDataset& dataset) : options_(options), crs_(crs_of(options, dataset)) {
    OGRSpatialReference wgs84;
    wgs84.importFromEPSG(4326);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    map_.reset(OGRCreateCoordinateTransformation(&crs_, &wgs84));
    if (!map_)
      throw InputError(options.dem, "crs", "cannot be turned into longitude and latitude" + QuietErrors::last());
  }

  const OGRSpatialReference& crs() const { return crs_; }

  /// x and y become longitude and latitude, degrees. Errors  InputError: a place that is none on the earth.
  void to_lon_lat(std::vector<double>& x, std::vector<double>& y) const {
    std::vector<int> ok(x.size(), 0);
    map_->Transform(x.size(), x.data(), y.data(), nullptr, ok.data());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (ok[i] == 0 || !(std::fabs(x[i]) <= 540) || !(std::fabs(y[i]) <= 90.0001))
        throw InputError(options_.dem, "crs",
                         "the raster's coordinates are not on the earth in its coordinate system (" + name() +
                             "); set the right one in the scene file");
  }

  std::string name() const {
    const char* text = crs_.GetName();
    return text != nullptr ? text : "unnamed";
  }

 private:
  const DemOptions& options_;
  OGRSpatialReference crs_;
  std::unique_ptr<OGRCoordinateTransformation> map_;
};

/// Of the orthophoto around a tile, so that filters meet no edge.
inline constexpr int margin_cells = 1;

/// The orthophoto over a tile and its margin, in the tile's own grid; grey where there is none.
EncodedImage read_ortho(const DemTile& tile, const Grid& grid, const EarthMap& earth);

}  // namespace gigabake
