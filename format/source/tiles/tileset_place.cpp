#include "format/source/tiles/tileset_place.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/source/earth_centred.h"

namespace gigabake {
namespace {

/// Max number of contents that are sampled, evenly spread over the tileset.
constexpr std::size_t max_sampled_contents = 16;
constexpr double near_m = 100e3;

enum class BoundsOf { statements, vertices };

WorldBox bounds_of_content(const TilesetContent& content, const SourceFiles& files, BoundsOf what) {
  TileRef tile;
  tile.path = content.path;
  tile.kind = content.kind;
  tile.gltf_up = content.gltf_up;
  tile.range = content.range;
  tile.archive = content.archive;
  tile.world_from_tile = content.world_from_tile;
  const WorldBox own = what == BoundsOf::statements
                           ? stated_bounds(tile, content.archive ? SourceFiles(content.archive) : files)
                           : vertex_bounds(tile, files.root());
  WorldBox out;
  for (unsigned corner = 0; corner < 8 && !own.is_empty; ++corner) {
    const auto at = [&](unsigned axis) { return corner >> axis & 1u ? own.high[axis] : own.low[axis]; };
    out.add(content.world_from_tile({at(0), at(1), at(2)}));
  }
  return out;
}

/// Returns the bounds of samples. Skips contents that cannot be read, which the scan reports.
std::vector<WorldBox> sampled_bounds(const Tileset& tileset, const SourceFiles& files, BoundsOf what) {
  const std::size_t contents = tileset.contents.size(), samples = std::min(contents, max_sampled_contents);
  std::vector<WorldBox> out;
  for (std::size_t i = 0; i < samples; ++i) {
    try {
      const WorldBox box = bounds_of_content(tileset.contents[i * contents / samples], files, what);
      if (!box.is_empty && std::isfinite(box.half_diagonal())) out.push_back(box);
    } catch (const std::exception&) {
      continue;
    }
  }
  return out;
}

bool is_near(const Point<Ecef>& anchor, const WorldBox& box) {
  const auto centre = box.centre();
  return std::hypot(anchor.x - centre.x, anchor.y - centre.y, anchor.z - centre.z) <= near_m + box.half_diagonal();
}

bool some_near(const Point<Ecef>& anchor, const std::vector<WorldBox>& boxes) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const WorldBox& box) { return is_near(anchor, box); });
}

Point<Ecef> centre_of(const WorldBox& box) {
  const auto centre = box.centre();
  return {centre.x, centre.y, centre.z};
}

/// Returns the centre of all boxes that are on the earth. If this centre is not at the earth's surface, returns the
/// centre of the first box.
std::optional<Point<Ecef>> place_of(const std::vector<WorldBox>& boxes) {
  WorldBox all;
  std::optional<Point<Ecef>> first;
  for (const WorldBox& box : boxes) {
    if (earth_fit(box) == EarthFit::none) continue;  // coordinates of tilesets are earth-centred, not projected
    if (!first) first = centre_of(box);
    all.join(box);
  }
  if (!first) return std::nullopt;
  return is_on_earth(centre_of(all), all.half_diagonal()) ? centre_of(all) : *first;
}

std::string text_of(const Point<Ecef>& p) {
  const Geodetic g = geodetic_of(p);
  return fmt::format("latitude {:.6g}°, longitude {:.6g}°", g.latitude_deg, g.longitude_deg);
}

}  // namespace

TilesetPlace tileset_place(const SourceFiles& files, const Tileset& tileset) {
  const std::optional<Point<Ecef>>& stated = tileset.anchor;
  std::vector<WorldBox> boxes = sampled_bounds(tileset, files, BoundsOf::statements);
  if (boxes.empty() || (stated && some_near(*stated, boxes))) return {stated, {}};
  if (!stated) return {place_of(boxes), {}};
  boxes = sampled_bounds(tileset, files, BoundsOf::vertices);
  if (boxes.empty() || some_near(*stated, boxes)) return {stated, {}};
  const std::optional<Point<Ecef>> place = place_of(boxes);
  return {place, fmt::format("warning: the tileset's root is at {}, its content {}", text_of(*stated),
                             place ? "at " + text_of(*place) + ": placed there"
                                   : "is in a local frame: not placed on the earth")};
}

}  // namespace gigabake
