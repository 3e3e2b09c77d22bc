/// Location of the pixels of a raster: on the earth, on another body, or in a plane.
#pragma once

#include <memory>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <vector>

#include "core/math/frames.h"
#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Map from the coordinate system of a raster to positions in metres.
/// The ellipsoid of the coordinate system determines the body: the earth or another body. A raster without a coordinate
/// system, or with a local coordinate system, lies in a plane. Only rasters on the earth have a georeference.
class Ground {
 public:
  /// Creates the map for a raster.
  /// Errors  InputError: the coordinate system is unknown or cannot be converted to longitude and latitude.
  Ground(const DemOptions& options, GDALDataset& dataset);

  bool is_on_earth() const { return kind_ == Kind::earth; }
  /// Returns a message with the reason why the raster is not on the earth, and the remedy; empty if it is on the earth.
  std::string why_not_on_earth() const;
  const OGRSpatialReference* crs() const { return crs_ ? &*crs_ : nullptr; }
  std::string name() const;

  /// Converts coordinates of the raster to longitude (x) and latitude (y) in degrees, or to metres in a plane.
  /// Returns 1 per point that could be converted, else 0.
  std::vector<char> locate(std::vector<double>& x, std::vector<double>& y) const;

  /// Converts a result of locate() to an origin with latitude y and longitude x. In a plane, these members hold y and x
  /// in metres.
  Geodetic origin(double x, double y) const;

  /// A map from results (x, y) of locate() and heights to the east-north-up frame at `origin`.
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

  /// Converts geodetic coordinates to Cartesian coordinates relative to the centre of the body.
  Point<Ecef> on_body(double lon_deg, double lat_deg, double height_m) const;

  Kind kind_ = Kind::plane;
  double radius_m_ = 0, eccentricity_squared_ = 0;  ///< ellipsoid of a body other than the earth
  double plane_unit_m_ = 1;
  std::optional<OGRSpatialReference> crs_;
  std::unique_ptr<OGRCoordinateTransformation> map_;
};

}  // namespace gigabake
