/// Detection of scene origins that are far from the sources, for example because latitude and longitude are swapped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/math/frames.h"

namespace gigabake {

/// Returns a warning if the chosen origin is more than 100 km from every place of the sources. The warning includes the
/// question whether latitude and longitude are swapped. `places` is empty if no source has a place on the earth.
std::optional<std::string> far_origin_warning(const Geodetic& origin, const std::vector<Geodetic>& places);

/// A source of a scene .json and its place on the earth.
struct NamedPlace {
  std::string name;  ///< "sources[1]"
  Geodetic place;
};

/// Returns one warning for all places that are more than 100 km from the first place.
std::optional<std::string> far_places_warning(const std::vector<NamedPlace>& places);

}  // namespace gigabake
