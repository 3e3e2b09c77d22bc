/// What the parts that GDAL reads share: datasets, grids, coordinate systems.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cpl_error.h>
#include <cstring>
#include <filesystem>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>

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

/// Pixels to coordinates, as GDAL's geotransform.
struct Grid {
  std::array<double, 6> g{0, 1, 0, 0, 0, 1};
  /// Returns the coordinates of a pixel's centre.
  std::pair<double, double> place(double column, double row) const {
    return {g[0] + g[1] * (column + 0.5) + g[2] * (row + 0.5), g[3] + g[4] * (column + 0.5) + g[5] * (row + 0.5)};
  }
  double determinant() const { return g[1] * g[5] - g[2] * g[4]; }
};

/// The raster's own where it names no files, else nothing.
const OGRSpatialReference* plain_crs_of(GDALDataset& dataset);

std::string wkt_of(const OGRSpatialReference& crs);

/// Returns the system that a text names: EPSG:…, WKT or a PROJ text.
/// Errors  InputError(file, key): unknown, or a text that leads to files.
OGRSpatialReference crs_of_text(const std::filesystem::path& file, const char* key, const std::string& text);

/// Returns the system of the options, else the raster's own, else nothing. Errors  InputError: an unknown one.
std::optional<OGRSpatialReference> whole_crs_of(const DemOptions& options, GDALDataset& dataset);

/// Likewise, without its vertical part.
std::optional<OGRSpatialReference> crs_of(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
