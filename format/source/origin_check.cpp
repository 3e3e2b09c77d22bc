#include "format/source/origin_check.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "core/base/quote.h"
#include "core/math/georeference.h"

namespace gigabake {
namespace {

constexpr double far_m = 100e3;

/// Returns the length of the straight line between two positions, which includes a difference in height.
double distance_m(const Geodetic& a, const Geodetic& b) {
  const Point<Ecef> p = ecef_of(a), q = ecef_of(b);
  return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

const Geodetic& nearest(const Geodetic& to, const std::vector<Geodetic>& places) {
  return *std::min_element(places.begin(), places.end(),
                           [&](const Geodetic& a, const Geodetic& b) { return distance_m(a, to) < distance_m(b, to); });
}

std::string text_of(const Geodetic& g) {
  return fmt::format("latitude {:.6g}°, longitude {:.6g}°, height {:.6g} m", g.latitude_deg, g.longitude_deg,
                     g.height_m);
}

/// Returns the question whether the coordinates of `g` are swapped. Adds the distance after swapping if it is at most
/// far_m.
std::string swap_question(const Geodetic& g, const Geodetic& expected) {
  const std::string question = "are its latitude and longitude swapped?";
  if (std::fabs(g.longitude_deg) > 90) return question;
  const Geodetic swapped{g.longitude_deg, g.latitude_deg, g.height_m};
  const double left_m = distance_m(swapped, expected);
  return question + (left_m <= far_m ? fmt::format(" Swapped, it would be {:.3g} km away", left_m / 1000) : "");
}

}  // namespace

std::optional<std::string> far_origin_warning(const Geodetic& origin, const std::vector<Geodetic>& places) {
  if (places.empty()) return std::nullopt;
  const Geodetic& place = nearest(origin, places);
  const double away_m = distance_m(origin, place);
  if (away_m <= far_m) return std::nullopt;
  return fmt::format("warning: `origin` ({}) is {:.0f} km from the source ({}); its order is LAT,LON,HEIGHT: {}",
                     text_of(origin), away_m / 1000, text_of(place), swap_question(origin, place));
}

std::optional<std::string> far_places_warning(const std::vector<NamedPlace>& places) {
  const NamedPlace* found = nullptr;
  std::size_t more = 0;
  for (const NamedPlace& p : places) {
    if (distance_m(p.place, places[0].place) <= far_m) continue;
    found == nullptr ? void(found = &p) : void(++more);
  }
  if (found == nullptr) return std::nullopt;
  return fmt::format("warning: {}{} ({}) is {:.0f} km from {} ({}); lon_lat_height begins with the longitude: {}",
                     short_path(found->name), more == 0 ? "" : fmt::format(" and {} more", more), text_of(found->place),
                     distance_m(found->place, places[0].place) / 1000, short_path(places[0].name),
                     text_of(places[0].place), swap_question(found->place, places[0].place));
}

}  // namespace gigabake
