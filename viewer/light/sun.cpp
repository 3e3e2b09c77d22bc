#include "viewer/light/sun.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <numbers>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr double degree = std::numbers::pi / 180;

double sine(double deg) { return std::sin(deg * degree); }
double cosine(double deg) { return std::cos(deg * degree); }

/// Reduces an angle to [0, 360).
double turned(double deg) { return deg - 360 * std::floor(deg / 360); }

/// Returns the Julian centuries since noon of January 1, 2000.
double centuries(JulianDay day) { return (day - 2451545) / 36525; }

[[noreturn]] void bad_time(const std::string& time) {
  throw UsageError("time",
                   fmt::format("expected a date and time from 1900 to 2100 with Z or its offset from UTC, such as "
                               "2026-06-21T15:00Z or 2026-06-21T17:00+02:00, got '{}'",
                               time));
}

struct DateAndTime {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  int rest = 0;  ///< index of the first character after the parsed text
};

DateAndTime date_and_time(const std::string& time) {
  DateAndTime t;
  const std::string form = "dddd-dd-ddTdd:dd";
  for (std::size_t i = 0; i < form.size(); ++i)
    if (i >= time.size() || (form[i] == 'd' ? time[i] < '0' || time[i] > '9' : time[i] != form[i])) bad_time(time);
  if (std::sscanf(time.c_str(), "%4d-%2d-%2dT%2d:%2d%n", &t.year, &t.month, &t.day, &t.hour, &t.minute, &t.rest) != 5)
    bad_time(time);
  int more = 0;
  if (std::sscanf(time.c_str() + t.rest, ":%2d%n", &t.second, &more) == 1) t.rest += more;
  const std::chrono::year_month_day date{std::chrono::year(t.year), std::chrono::month(unsigned(t.month)),
                                         std::chrono::day(unsigned(t.day))};
  const bool in_day = t.hour >= 0 && t.hour < 24 && t.minute >= 0 && t.minute < 60 && t.second >= 0 && t.second < 60;
  if (t.year < 1900 || t.year > 2100 || !date.ok() || !in_day) bad_time(time);
  return t;
}

/// Returns the offset of local time from UTC in minutes. `zone` is Z or an offset such as +02:00. `time` is the whole
/// text, for the error message.
int utc_offset_minutes(const std::string& zone, const std::string& time) {
  if (zone == "Z") return 0;
  int hours = 0, minutes = 0, end = 0;
  char sign = 0;
  const bool is_read = std::sscanf(zone.c_str(), "%c%2d:%2d%n", &sign, &hours, &minutes, &end) == 3;
  if (!is_read || std::size_t(end) != zone.size() || (sign != '+' && sign != '-') || hours < 0 || hours > 14 ||
      minutes < 0 || minutes > 59)
    bad_time(time);
  return (sign == '-' ? -1 : 1) * (60 * hours + minutes);
}

/// Returns the refraction at an elevation, in degrees.
/// Source  Sæmundsson 1986, in Meeus 1998, chapter 16.
double refraction_deg(double elevation_deg) {
  if (elevation_deg < -1) return 0;
  return 1.02 / 60 / std::tan((elevation_deg + 10.3 / (elevation_deg + 5.11)) * degree);
}

}  // namespace

Vec3d to_sun(const SunDirection& sun) {
  const double level = cosine(sun.elevation_deg);
  return {sine(sun.azimuth_deg) * level, cosine(sun.azimuth_deg) * level, sine(sun.elevation_deg)};
}

JulianDay julian_day(const std::string& time) {
  const DateAndTime t = date_and_time(time);
  const std::chrono::sys_days date = std::chrono::year_month_day{
      std::chrono::year(t.year), std::chrono::month(unsigned(t.month)), std::chrono::day(unsigned(t.day))};
  const double minutes =
      60.0 * t.hour + t.minute + t.second / 60.0 - utc_offset_minutes(time.substr(std::size_t(t.rest)), time);
  return 2440587.5 + double(date.time_since_epoch().count()) + minutes / 1440;
}

SunOnSky sun_on_sky(JulianDay day) {
  const double t = centuries(day);
  const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
  const double anomaly = 357.52911 + t * (35999.05029 - t * 0.0001537);
  const double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * sine(anomaly) +
                        (0.019993 - 0.000101 * t) * sine(2 * anomaly) + 0.000289 * sine(3 * anomaly);
  const double node = 125.04 - 1934.136 * t;
  const double longitude = mean_longitude + centre - 0.00569 - 0.00478 * sine(node);
  const double tilt = 23.43929111 - t * (0.013004167 + t * (1.639e-7 - t * 5.036e-7)) + 0.00256 * cosine(node);
  return {turned(std::atan2(cosine(tilt) * sine(longitude), cosine(longitude)) / degree),
          std::asin(sine(tilt) * sine(longitude)) / degree};
}

SunDirection sun_at(const Geodetic& place, JulianDay day) {
  const double t = centuries(day);
  const SunOnSky sun = sun_on_sky(day);
  const double sidereal = 280.46061837 + 360.98564736629 * (day - 2451545) + t * t * 0.000387933;
  const double hour = sidereal + place.longitude_deg - sun.right_ascension_deg;
  const double lat = place.latitude_deg, dec = sun.declination_deg;
  const double up = sine(lat) * sine(dec) + cosine(lat) * cosine(dec) * cosine(hour);
  const double north = cosine(lat) * sine(dec) - sine(lat) * cosine(dec) * cosine(hour);
  const double east = -cosine(dec) * sine(hour);
  const double elevation = std::atan2(up, std::hypot(north, east)) / degree;
  return {turned(std::atan2(east, north) / degree), elevation + refraction_deg(elevation)};
}

}  // namespace gigabake
