/// Position of the sun: specified, or computed from time and place.
#pragma once

#include <string>

#include "core/math/frames.h"
#include "core/math/vec3.h"

namespace gigabake {

/// Direction to the sun in scene coordinates, x east and y north.
struct SunDirection {
  double azimuth_deg = 225;   ///< clockwise from north
  double elevation_deg = 42;  ///< above the horizon; below 0 the sun has set
  friend bool operator==(const SunDirection&, const SunDirection&) = default;
};

/// Returns the unit vector to the sun.
Vec3d to_sun(const SunDirection& sun);

/// Days in UTC since noon of January 1, 4713 BC; 2451545 is noon of January 1, 2000.
using JulianDay = double;

/// Parses a time such as "2026-06-21T15:00Z". The format is ISO 8601 in UTC (Z) or with an offset from UTC (+02:00);
/// seconds are optional.
/// Range   Years 1900 to 2100.
/// Errors  UsageError: the text has another format or is out of range.
JulianDay julian_day(const std::string& time);

/// The sun's equatorial coordinates, for the equinox of date.
/// Range   right_ascension_deg in [0, 360).
struct SunOnSky {
  double right_ascension_deg, declination_deg;
};

/// Returns the sun's apparent position; error ≤ 0.01° from 1900 to 2100.
/// Source  Meeus 1998, "Astronomical Algorithms", chapter 25 (lower accuracy).
SunOnSky sun_on_sky(JulianDay day);

/// Returns the sun's direction at a place on the earth. The direction includes refraction by air of 1010 hPa and 10 °C.
/// Exact   The error above the horizon is at most 0.02°.
/// Source  Meeus 1998, chapters 12, 13 and 16.
SunDirection sun_at(const Geodetic& place, JulianDay day);

}  // namespace gigabake
