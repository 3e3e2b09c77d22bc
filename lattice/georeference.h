/// From the WGS84 earth to the scene's east-north-up frame.
#pragma once

#include <optional>

#include "lattice/frames.h"

namespace gigabake {

/// Does what lies within `radius_m` of the point stand on the earth?
/// Range  true between 12 km below and 100 km above the ellipsoid; the centre of a wide piece of ground lies deeper, by
///        up to radius²/2R.
bool is_on_earth(const Point<Ecef>& p_ecef_m, double radius_m = 0);

Geodetic geodetic_of(const Point<Ecef>& p_ecef_m);
Point<Ecef> ecef_of(const Geodetic& position);

/// East-north-up at `origin` as one rigid map. Exact  rotation and translation in double, from GeographicLib.
Affine<Scene, Ecef> scene_from_ecef(const Geodetic& origin);

/// East-north-up axes at `position`, in ECEF. Inverse of scene_from_ecef.
Affine<Ecef, Scene> ecef_from_enu(const Geodetic& position);

}  // namespace gigabake
