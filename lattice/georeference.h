/// From the WGS84 earth to the scene's east-north-up frame.
#pragma once

#include <optional>

#include "lattice/frames.h"

namespace gigabake {

/// Whether something with this centre and this radius can stand on the earth's surface.
/// Range  true for centres from 12 km below to 100 km above the ellipsoid; the centre of a wide piece of ground lies up
///        to radius²/2R deeper (R: the earth's radius), which is allowed for.
bool is_on_earth(const Point<Ecef>& p_ecef_m, double radius_m = 0);

Geodetic geodetic_of(const Point<Ecef>& p_ecef_m);
Point<Ecef> ecef_of(const Geodetic& position);

/// East-north-up at `origin` as one rigid map. Exact  rotation and translation in double, from GeographicLib.
Affine<Scene, Ecef> scene_from_ecef(const Geodetic& origin);

/// East-north-up axes at `position`, in ECEF. Inverse of scene_from_ecef.
Affine<Ecef, Scene> ecef_from_enu(const Geodetic& position);

}  // namespace gigabake
