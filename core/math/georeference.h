/// Conversions between WGS84 coordinates and the scene's east-north-up frame.
#pragma once

#include <optional>

#include "core/math/frames.h"

namespace gigabake {

/// Returns true if an object with this centre and radius can be located on the earth's surface.
/// Range   Accepts centres from 12 km below to 100 km above the ellipsoid. The lower limit is radius²/2R deeper (R: the
///         earth's radius), because the centre of a wide piece of ground is below its surface. Ignores radii over 3000
///         km.
bool is_on_earth(const Point<Ecef>& p_ecef_m, double radius_m = 0);

Geodetic geodetic_of(const Point<Ecef>& p_ecef_m);
Point<Ecef> ecef_of(const Geodetic& position);

/// Returns the rigid map from ECEF to the east-north-up frame at `origin`.
/// Exact   Rotation and translation in double, from GeographicLib.
Affine<Scene, Ecef> scene_from_ecef(const Geodetic& origin);

/// Returns the map from the east-north-up frame at `position` to ECEF; the inverse of scene_from_ecef().
Affine<Ecef, Scene> ecef_from_enu(const Geodetic& position);

}  // namespace gigabake
