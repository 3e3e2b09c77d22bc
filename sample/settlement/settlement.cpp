#include "sample/settlement/settlement.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr double village_radius_m = 120, tree_cell_m = 6.5, house_sight_m = 24;

/// Returns the angle of the direction (e, n) in degrees, counter-clockwise from east. Searches the
/// angle by bisection with turn_of(), because libm may return other bits on other machines.
double heading_of(double e, double n) {
  const bool back = n < 0 || (n == 0 && e < 0);
  if (back) e = -e, n = -n;
  double low = 0, high = 180;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    const Turn t = turn_of(middle);
    (t.cosine * n - t.sine * e > 0 ? low : high) = middle;
  }
  return low + (back ? 180 : 0);
}

MapPoint inside(MapPoint p, double half_m) {
  return {std::clamp(p.e_m, -half_m, half_m), std::clamp(p.n_m, -half_m, half_m)};
}

House draw_house(Random& random, double road_heading_deg) {
  House h;
  h.length_m = random.between(8, 13);
  h.depth_m = random.between(6.5, 8.5);
  h.wall_m = random.below(3) == 0 ? random.between(5, 5.6) : random.between(2.8, 3.4);
  h.roof_m = h.depth_m * random.between(0.36, 0.5);
  const double across_deg = random.below(4) == 0 ? 90 : 0;
  h.heading_deg = road_heading_deg + across_deg + random.between(-4, 4);
  h.wall_tint = random.below(4);
  h.roof_tint = random.below(3);
  return h;
}

}  // namespace

Settlement::Settlement(const Relief& relief, std::uint32_t seed)
    : relief_(relief), seed_(seed), roads_(relief.size_m()), near_houses_(relief.size_m(), house_sight_m) {
  lay_roads();
  for (const Road& road : roads_.roads())
    for (const MapPoint& village : villages_)
      if (road.kind != RoadKind::track) build_along(road, village, village_radius_m);
}

void Settlement::lay_roads() {
  const double half_m = relief_.size_m() / 2, rim_m = half_m * 0.999;
  ScanThread scanner(relief_);
  Random random(hash_of(seed_, 40));
  const auto east_bank = [&](double along_m) {
    return inside(relief_.river().beside(along_m, 0.09 * relief_.relief_m() + 18), rim_m);
  };
  const int villages = std::clamp(int(relief_.size_m() / 700), 1, 24);
  std::vector<MapPoint> stops{east_bank(-1.2 * half_m)};
  for (int i = 0; i < villages; ++i) {
    villages_.push_back(east_bank(relief_.size_m() * 0.8 * ((i + 0.5) / villages - 0.5)));
    stops.push_back(villages_.back());
  }
  stops.push_back(east_bank(1.2 * half_m));
  for (std::size_t i = 0; i + 1 < stops.size(); ++i)
    roads_.add({RoadKind::main, 2.8, scanner.way(stops[i], stops[i + 1])});
  for (const MapPoint& v : villages_) {
    for (int k = 0; k < 3; ++k) {
      const Turn t = turn_of(k * 120 + random.between(0, 70));
      const double reach_m = random.between(70, 115);
      roads_.add({RoadKind::street, 2.0,
                  scanner.way(v, inside({v.e_m + reach_m * t.cosine, v.n_m + reach_m * t.sine}, rim_m))});
    }
    for (int k = 0; k < 2; ++k) {
      const Turn t = turn_of(random.between(0, 360));
      roads_.add(
          {RoadKind::track, 1.3, scanner.way(v, inside({v.e_m + half_m * t.cosine, v.n_m + half_m * t.sine}, rim_m))});
    }
  }
}

bool Settlement::can_build(const House& house) const {
  const double half_m = relief_.size_m() / 2 - house.length_m;
  if (std::fabs(house.centre.e_m) > half_m || std::fabs(house.centre.n_m) > half_m) return false;
  if (relief_.slope(house.centre) > 0.3 || relief_.river().at(house.centre).shore_m < 12) return false;
  if (roads_.nearest(house.centre).edge_m < house.depth_m / 2 + 1.5) return false;
  const auto near = near_houses_.near(house.centre);
  return std::none_of(near.begin(), near.end(), [&](int i) {
    const House& other = houses_[std::size_t(i)];
    return distance_m(house.centre, other.centre) < (house.length_m + other.length_m) / 2 + 3;
  });
}

void Settlement::build_along(const Road& road, MapPoint centre, double radius_m) {
  Random random(hash_of(seed_, 50, std::int32_t(houses_.size() + road.points.size())));
  double next_m = 6, along_m = 0;
  for (std::size_t i = 0; i + 1 < road.points.size(); ++i) {
    const MapPoint a = road.points[i], b = road.points[i + 1];
    const double step_m = distance_m(a, b);
    for (; next_m < along_m + step_m; next_m += random.between(7, 12)) {
      const double t = (next_m - along_m) / step_m, de = (b.e_m - a.e_m) / step_m, dn = (b.n_m - a.n_m) / step_m;
      for (const double side : {-1.0, 1.0}) {
        House h = draw_house(random, heading_of(de, dn));
        const double away_m = side * (road.half_width_m + random.between(4, 8) + h.depth_m / 2);
        h.centre = {lerp(a.e_m, b.e_m, t) - away_m * dn, lerp(a.n_m, b.n_m, t) + away_m * de};
        if (distance_m(h.centre, centre) >= radius_m || random.below(5) == 0 || !can_build(h)) continue;
        near_houses_.add(h.centre, h.centre, int(houses_.size()));
        houses_.push_back(h);
      }
    }
    along_m += step_m;
  }
}

double Settlement::to_house_m(MapPoint p) const {
  double nearest_m = house_sight_m;
  for (const int i : near_houses_.near(p))
    nearest_m = std::min(nearest_m, distance_m(p, houses_[std::size_t(i)].centre));
  return nearest_m;
}

bool Settlement::tree_at(std::int32_t x, std::int32_t y, Tree& tree) const {
  Random random(hash_of(seed_ + 60, x, y));
  tree.foot = {(x + random.between(0.05, 0.95)) * tree_cell_m, (y + random.between(0.05, 0.95)) * tree_cell_m};
  tree.seed = random.next();
  const double slope = relief_.slope(tree.foot), shore_m = relief_.river().at(tree.foot).shore_m;
  if (shore_m < 1.5 || slope > 0.9) return false;
  const double forest =
      smooth_step(-0.02, 0.24, noise(seed_ + 61, tree.foot.e_m / 90, tree.foot.n_m / 90) + 0.35 * slope);
  const double by_water = 0.5 * smooth_step(14, 4, shore_m);
  if (random.between(0, 1) > 0.02 + std::max(0.85 * forest, by_water)) return false;
  if (roads_.nearest(tree.foot).edge_m < 2.2 || to_house_m(tree.foot) < 9.5) return false;
  const double dry = 1 - relief_.moisture(tree.foot);
  tree.kind =
      random.between(0, 1) < 0.15 + 0.6 * smooth_step(0.25, 0.7, slope) * dry ? TreeKind::conifer : TreeKind::broadleaf;
  tree.height_m = random.between(5.5, 11) * (tree.kind == TreeKind::conifer ? 1.3 : 1);
  tree.crown_m = tree.height_m * (tree.kind == TreeKind::conifer ? 0.36 : random.between(0.55, 0.75));
  return true;
}

std::vector<Tree> Settlement::trees_in(MapPoint min, MapPoint max) const {
  std::vector<Tree> trees;
  const auto cell = [](double m) { return std::int32_t(std::floor(m / tree_cell_m)); };
  for (std::int32_t y = cell(min.n_m); y <= cell(max.n_m); ++y)
    for (std::int32_t x = cell(min.e_m); x <= cell(max.e_m); ++x) {
      Tree tree;
      if (!tree_at(x, y, tree)) continue;
      const MapPoint p = tree.foot;
      if (p.e_m >= min.e_m && p.e_m < max.e_m && p.n_m >= min.n_m && p.n_m < max.n_m) trees.push_back(tree);
    }
  return trees;
}

}  // namespace gigabake::sample
