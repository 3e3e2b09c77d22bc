/// Where the pixels of a raster lie: on the earth, on another body, or in a plane.
#pragma once

#include <memory>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"
#include "lattice/frames.h"

namespace gigabake {

/// A raster's coordinate system as a map to places in metres.
/// Its kind follows from the coordinate system: one of another body's ellipsoid leads to that body; a local system, or
/// none, is a plane. Only the earth has a georeference.
class Ground {
 public:
  /// Errors  InputError: a coordinate system that leads to no longitude and latitude.
  Ground(const DemOptions& options, GDALDataset& dataset);

  bool is_on_earth() const { return kind_ == Kind::earth; }
  /// Returns why the raster has no place on the earth, and what to do; empty if it has one.
  std::string why_not_on_earth() const;
  const OGRSpatialReference* crs() const { return crs_ ? &*crs_ : nullptr; }
  std::string name() const;

  /// Turns coordinates of the raster into degrees of longitude and latitude, or into metres in a plane.
  /// Returns per point whether it has such a place.
  std::vector<char> locate(std::vector<double>& x, std::vector<double>& y) const;

  /// Returns a place of locate() as a point of the raster's frame: latitude y and longitude x, or y and x in metres.
  Geodetic origin(double x, double y) const;

  /// Returns the map from (x, y) of locate() and a height to a frame with east, north and up at `origin`.
  class Frame {
   public:
    Frame(const Ground& ground, const Geodetic& origin);
    Point<Scene> operator()(double x, double y, double height_m) const;

   private:
    const Ground& ground_;
    Geodetic origin_;
    Affine<Scene, Ecef> scene_from_body_;
  };

 private:
  enum class Kind : std::uint8_t { earth, body, plane };

  /// Returns a place on the body's ellipsoid, relative to its centre.
  Point<Ecef> on_body(double lon_deg, double lat_deg, double height_m) const;

  Kind kind_ = Kind::plane;
  double radius_m_ = 0, eccentricity_squared_ = 0;  ///< of another body
  double plane_unit_m_ = 1;
  std::optional<OGRSpatialReference> crs_;
  std::unique_ptr<OGRCoordinateTransformation> map_;
};

}  // namespace gigabake
