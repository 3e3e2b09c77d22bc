/// From the WGS84 earth to the scene's east-north-up frame.
#pragma once

#include <optional>

#include "format/frames.h"

namespace gigabake {

/// Range  true between 12 km below and 100 km above the ellipsoid: a tileset's root there stands on the earth.
bool is_on_earth(const Point<Ecef>& p_ecef_m);

Geodetic geodetic_of(const Point<Ecef>& p_ecef_m);
Point<Ecef> ecef_of(const Geodetic& position);

/// East-north-up at `origin` as one rigid map. Exact  rotation and translation in double, from GeographicLib.
Affine<Scene, Ecef> scene_from_ecef(const Geodetic& origin);

/// East-north-up axes at `position`, in ECEF. Inverse of scene_from_ecef.
Affine<Ecef, Scene> ecef_from_enu(const Geodetic& position);

}  // namespace gigabake
