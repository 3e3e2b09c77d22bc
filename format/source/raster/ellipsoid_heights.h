/// Conversion of a raster's heights to heights above the WGS84 ellipsoid.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/source/raster/proj_operations.h"
#include "format/source/raster/vertical_system.h"

namespace gigabake {

/// A map from heights in the vertical system of a raster to heights above the WGS84 ellipsoid. It is the identity if
/// the raster has no vertical system, is not on the earth, or has a `geoid_offset_m`, which replaces the system.
class EllipsoidHeights {
 public:
  /// Errors  InputError(file, "crs"): PROJ has no transformation, or misses a grid. The message names the grid and its
  ///         origin. `bounds` is the extent of the raster.
  EllipsoidHeights(const DemOptions& options, GDALDataset& dataset, bool is_on_earth,
                   const std::optional<LonLatBounds>& bounds = std::nullopt);

  bool is_identity() const { return !map_; }
  const std::optional<VerticalSystem>& system() const { return system_; }

  /// Converts heights in metres, upwards from the zero of the vertical system, in place. x and y are coordinates of the
  /// raster. Heights outside the area of the transformation become NaN.
  /// Exact   A result depends only on the point, so neighbouring tiles agree.
  void convert(std::vector<double> x, std::vector<double> y, std::vector<double>& height_m) const;

  /// Returns a message that the transformation does not cover a raster or a part of it.
  std::string why_not_covered(const LonLatBounds& area) const;

  /// Returns the transformation in an area; nullopt if is_identity().
  std::optional<UsedTransformation> transformation(const LonLatBounds& area) const;

 private:
  struct Destroy {
    void operator()(OGRCoordinateTransformation* map) const { OGRCoordinateTransformation::DestroyCT(map); }
  };

  std::optional<VerticalSystem> system_;
  OGRSpatialReference ellipsoid_;
  std::unique_ptr<OGRCoordinateTransformation, Destroy> map_;
};

/// Returns one line that states how heights of a raster are understood; empty if `geoid_offset_m` states it.
std::string heights_note(const DemOptions& options, const EllipsoidHeights& heights, const LonLatBounds& area);

}  // namespace gigabake
