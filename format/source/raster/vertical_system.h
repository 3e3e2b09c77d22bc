/// The vertical reference system of a raster's heights.
#pragma once

#include <optional>
#include <string>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// A reference system of heights. Its zero is a geoid, a tide gauge, or the ellipsoid of a coordinate system with three
/// axes.
struct VerticalSystem {
  std::string name;
  double unit_m = 1;
  bool is_depth = false;        ///< the axis counts downwards
  bool is_ellipsoidal = false;  ///< heights are above the ellipsoid of the coordinate system
  /// The horizontal system of the raster together with this vertical system. Nullopt if the raster has no horizontal
  /// system, or if the file's third axis belongs to another horizontal system.
  std::optional<OGRSpatialReference> whole = std::nullopt;
};

/// Returns the vertical system of the options, else of the raster, else nullopt.
/// SRTM HGT files have EGM96 heights by definition.
/// Errors  InputError: the coordinate system is unknown.
std::optional<VerticalSystem> vertical_system_of(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
