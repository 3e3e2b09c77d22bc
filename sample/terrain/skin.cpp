#include "sample/terrain/skin.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr Rgb deep_water{38, 62, 66}, shallow_water{86, 108, 94}, gravel{166, 156, 138}, meadow{104, 124, 62},
    dry_meadow{148, 142, 86};
constexpr Rgb wood_floor{72, 78, 42}, scree{140, 130, 114}, rock{122, 116, 108}, dark_rock{92, 88, 84};
constexpr Rgb asphalt{96, 95, 94}, dirt{156, 134, 102}, marking{206, 204, 198}, garden{112, 136, 66};
constexpr double field_m = 62;

Rgb water_colour(const Reach& reach) { return mix(shallow_water, deep_water, smooth_step(0, -5, reach.shore_m)); }

/// Returns the colour of farmland: fields with one crop each, in rows. The fields are cells of a rotated grid.
Rgb field_colour(std::uint32_t seed, MapPoint p, const Rgb& meadow_here) {
  const double u = (p.e_m * 0.94 + p.n_m * 0.34) / field_m, v = (p.n_m * 0.94 - p.e_m * 0.34) / (1.6 * field_m);
  const auto x = std::int32_t(std::floor(u)), y = std::int32_t(std::floor(v));
  const std::uint32_t h = hash_of(seed + 70, x, y);
  constexpr Rgb crops[4] = {{172, 156, 88}, {126, 142, 68}, {138, 112, 80}, {154, 160, 92}};
  if (h % 5 == 4) return meadow_here;
  const double row = noise(seed + 71, u * field_m / 1.4, double(h % 97));
  const double hedge = std::min({u - x, x + 1 - u, 1.6 * (v - y), 1.6 * (y + 1 - v)});
  return mix(wood_floor, scaled(crops[h % 5], 1 + 0.16 * row), smooth_step(0.008, 0.03, hedge));
}

/// Returns the colour of cracked, weathered rock: ridged noise at two scales.
Rgb rock_colour(std::uint32_t seed, MapPoint p) {
  const double blocks = ridged_noise(seed + 75, p.e_m / 7, p.n_m / 7, 5);
  const double cracks = ridged_noise(seed + 76, p.e_m / 1.9, p.n_m / 1.9, 3);
  return scaled(mix(rock, dark_rock, smooth_step(0.15, 0.75, blocks)), 1.12 - 0.35 * cracks * cracks);
}

Rgb land_colour(const Relief& relief, std::uint32_t seed, MapPoint p, const Reach& reach) {
  const double slope = relief.slope(p), moisture = relief.moisture(p);
  const double patchy = fractal_noise(seed + 72, p.e_m / 23, p.n_m / 23, 3);
  const double grain = noise(seed + 73, p.e_m / 0.7, p.n_m / 0.7);
  Rgb c = mix(dry_meadow, meadow, clamp01(0.25 + 0.9 * moisture + 0.7 * patchy));
  const double flat = smooth_step(0.2, 0.1, slope) * smooth_step(16, 26, reach.shore_m);
  c = mix(c, field_colour(seed, p, c), flat);
  const double forest = smooth_step(-0.02, 0.24, noise(seed + 61, p.e_m / 90, p.n_m / 90) + 0.35 * slope);
  c = mix(c, wood_floor, 0.75 * forest * smooth_step(12, 20, reach.shore_m));
  c = mix(c, scree, smooth_step(0.5, 0.75, slope + 0.25 * patchy));
  const double bare = smooth_step(0.62, 0.95, slope + 0.2 * patchy);
  if (bare > 0) c = mix(c, rock_colour(seed, p), bare);
  c = mix(gravel, c, smooth_step(0.6, 3.2, reach.shore_m + 1.5 * patchy));
  return scaled(c, 1 + 0.10 * grain - 0.35 * std::max(0.0, relief.hollowness(p)));
}

Rgb with_road(const RoadSight& sight, std::uint32_t seed, MapPoint p, const Rgb& land) {
  if (sight.edge_m > 0.9) return land;
  const double wear = 1 + 0.12 * fractal_noise(seed + 74, p.e_m / 2, p.n_m / 2, 3);
  Rgb c = scaled(sight.kind == RoadKind::track ? dirt : asphalt, wear);
  if (sight.kind == RoadKind::track)  // grass between the wheels
    c = mix(mix(land, dirt, 0.3), c, smooth_step(0.15, 0.4, sight.middle_m));
  if (sight.kind == RoadKind::main && sight.middle_m < 0.12) c = marking;
  return mix(c, mix(dirt, land, 0.5), smooth_step(-0.1, 0.7, sight.edge_m));
}

}  // namespace

Rgb ground_colour(const Relief& relief, const Settlement& settlement, std::uint32_t seed, MapPoint p) {
  const Reach reach = relief.river().at(p);
  const RoadSight sight = settlement.roads().nearest(p);
  const Rgb land = reach.shore_m < 0 ? water_colour(reach) : land_colour(relief, seed, p, reach);
  const Rgb tended = mix(land, garden, reach.shore_m < 0 ? 0 : 0.7 * smooth_step(16, 9, settlement.to_house_m(p)));
  return with_road(sight, seed, p, tended);
}

Picture paint_ground(const Relief& relief, const Settlement& settlement, std::uint32_t seed, MapPoint min,
                     MapPoint size_m, GridSize texels) {
  Picture picture(texels.e, texels.n, 3);
  const double texel_e_m = size_m.e_m / texels.e, texel_n_m = size_m.n_m / texels.n;
  for (int y = 0; y < texels.n; ++y)
    for (int x = 0; x < texels.e; ++x)
      picture.set(x, y,
                  ground_colour(relief, settlement, seed,
                                {min.e_m + (x + 0.5) * texel_e_m, min.n_m + size_m.n_m - (y + 0.5) * texel_n_m}));
  return picture;
}

}  // namespace gigabake::sample
