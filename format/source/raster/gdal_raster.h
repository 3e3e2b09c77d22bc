/// Error handling, grids and coordinate systems, shared by all code that reads rasters with GDAL.
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

#include "core/base/error.h"
#include "format/source/raster/dem.h"

namespace gigabake {

/// Scope in which GDAL prints no errors; last() returns the text of the last error. A fatal error means that no memory
/// is left: the process then prints a message and exits, because GDAL would abort.
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

/// Affine map from pixels to coordinates, in the form of GDAL's geotransform.
struct Grid {
  std::array<double, 6> g{0, 1, 0, 0, 0, 1};
  /// Returns the coordinates of a pixel's centre.
  std::pair<double, double> place(double column, double row) const {
    return {g[0] + g[1] * (column + 0.5) + g[2] * (row + 0.5), g[3] + g[4] * (column + 0.5) + g[5] * (row + 0.5)};
  }
  double determinant() const { return g[1] * g[5] - g[2] * g[4]; }
};

/// Returns the coordinate system of the raster; null if there is none or its text names files.
const OGRSpatialReference* plain_crs_of(GDALDataset& dataset);

std::string wkt_of(const OGRSpatialReference& crs);

/// Returns a number as text with up to six significant digits.
std::string short_number(double v);

/// Returns the coordinate system that a text names: EPSG:…, WKT or a PROJ text.
/// Errors  InputError(file, key): the text is unknown or names files.
OGRSpatialReference crs_of_text(const std::filesystem::path& file, const char* key, const std::string& text);

/// Returns the coordinate system of the options, else of the raster, else nullopt.
/// Errors  InputError: the coordinate system is unknown.
std::optional<OGRSpatialReference> whole_crs_of(const DemOptions& options, GDALDataset& dataset);

/// Returns whole_crs_of() without the vertical part.
std::optional<OGRSpatialReference> crs_of(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
