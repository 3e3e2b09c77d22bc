/// Where the sun stands: given, or by time and place.
#pragma once

#include <array>
#include <string>

#include "lattice/frames.h"

namespace gigabake {

/// As a scene sees it, x east and y north.
struct SunDirection {
  double azimuth_deg = 225;   ///< from north by east
  double elevation_deg = 42;  ///< above the horizon; below 0 there is no sun
  friend bool operator==(const SunDirection&, const SunDirection&) = default;
};

/// Unit.
std::array<double, 3> to_sun(const SunDirection& sun);

/// Days since noon of January 1, 4713 BC, UTC; 2451545 is noon of January 1, 2000.
using JulianDay = double;

/// Of "2026-06-21T15:00Z": ISO 8601 with the seconds or without, in UTC (Z) or with its distance to it (+02:00).
/// Range   years 1900 to 2100.
/// Errors  UsageError says what is wrong with it.
JulianDay julian_day(const std::string& time);

/// On the sky, of the date. Range  right ascension 0 … 360.
struct SunOnSky {
  double right_ascension_deg, declination_deg;
};

/// The sun's apparent place, to 0.01° from 1900 to 2100.
/// Source  Meeus 1998, "Astronomical Algorithms", chapter 25 (lower accuracy).
SunOnSky sun_on_sky(JulianDay day);

/// From a place on the earth, raised as much as the air (1010 hPa, 10 °C) raises it: to 0.02° above the horizon.
/// Source  Meeus 1998, chapters 12, 13 and 16.
SunDirection sun_at(const Geodetic& place, JulianDay day);

}  // namespace gigabake
