#include "sample/settlement/roads.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr double bridge_burden = 14, wet_burden = 2.5, slope_burden = 90;

int scan_points(double size_m) { return 1 + int(std::clamp(size_m / 6, 40.0, 256.0)); }

/// Smooths a path over a grid to a road by cutting corners (Chaikin) three times.
std::vector<MapPoint> smoothed(std::vector<MapPoint> way) {
  for (int round = 0; round < 3 && way.size() > 2; ++round) {
    std::vector<MapPoint> next{way.front()};
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      const MapPoint &a = way[i], &b = way[i + 1];
      next.push_back({lerp(a.e_m, b.e_m, 0.25), lerp(a.n_m, b.n_m, 0.25)});
      next.push_back({lerp(a.e_m, b.e_m, 0.75), lerp(a.n_m, b.n_m, 0.75)});
    }
    next.push_back(way.back());
    way = next;
  }
  return way;
}

/// Returns every third point and the end of a path over a grid, because fewer points have fewer kinks to smooth.
std::vector<MapPoint> thinned(const std::vector<MapPoint>& way) {
  std::vector<MapPoint> kept;
  for (std::size_t i = 0; i < way.size(); i += 3) kept.push_back(way[i]);
  if ((way.size() - 1) % 3 != 0) kept.push_back(way.back());
  return kept;
}

double to_segment_m(MapPoint p, MapPoint a, MapPoint b) {
  const double de = b.e_m - a.e_m, dn = b.n_m - a.n_m;
  const double square = de * de + dn * dn;
  const double t = square > 0 ? clamp01(((p.e_m - a.e_m) * de + (p.n_m - a.n_m) * dn) / square) : 0;
  return distance_m(p, {a.e_m + t * de, a.n_m + t * dn});
}

}  // namespace

double distance_m(MapPoint a, MapPoint b) {
  const double de = a.e_m - b.e_m, dn = a.n_m - b.n_m;
  return std::sqrt(de * de + dn * dn);
}

ScanThread::ScanThread(const Relief& relief)
    : height_(scan_points(relief.size_m()), -relief.size_m() / 2, relief.size_m() / 2), burden_(height_.v.size(), 1) {
  for (int y = 0; y < height_.edge; ++y)
    for (int x = 0; x < height_.edge; ++x) {
      const MapPoint p = height_.point(x, y);
      const double shore_m = relief.river().at(p).shore_m;
      height_.at(x, y) = relief.height_m(p);
      burden_[y * height_.edge + x] = shore_m < 0 ? bridge_burden : shore_m < 12 ? wet_burden : 1;
    }
}

int ScanThread::nearest(MapPoint p) const {
  const auto index = [&](double m) {
    return std::clamp(int((m - height_.min_m) / height_.cell_m + 0.5), 0, height_.edge - 1);
  };
  return index(p.n_m) * height_.edge + index(p.e_m);
}

double ScanThread::effort(int from, int to, double run_m) const {
  const double slope = (height_.v[to] - height_.v[from]) / run_m;
  return run_m * (0.5 * (burden_[from] + burden_[to])) * (1 + slope_burden * slope * slope);
}

std::vector<int> ScanThread::minimum(int from, int to) const {
  struct Front {
    double effort;
    int index;
    bool operator<(const Front& o) const { return effort != o.effort ? effort > o.effort : index > o.index; }
  };
  const int edge = height_.edge;
  std::vector<double> best(height_.v.size(), 1e300);
  std::vector<int> before(height_.v.size(), -1);
  std::priority_queue<Front> front;
  best[from] = 0;
  front.push({0, from});
  while (!front.empty() && front.top().index != to) {
    const Front at = front.top();
    front.pop();
    if (at.effort > best[at.index]) continue;
    const int x = at.index % edge, y = at.index / edge;
    // Knight's moves in addition to the eight neighbours: sixteen directions.
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const int nx = x + dx, ny = y + dy;
        const bool straight_double = (dx % 2 == 0) && (dy % 2 == 0);
        if (straight_double || nx < 0 || ny < 0 || nx >= edge || ny >= edge) continue;
        const int next = ny * edge + nx;
        const double total = at.effort + effort(at.index, next, height_.cell_m * std::sqrt(double(dx * dx + dy * dy)));
        if (total >= best[next]) continue;
        best[next] = total;
        before[next] = at.index;
        front.push({total, next});
      }
  }
  std::vector<int> way{to};
  while (before[way.back()] >= 0) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<MapPoint> ScanThread::way(MapPoint from, MapPoint to) {
  std::vector<MapPoint> points;
  for (const int i : minimum(nearest(from), nearest(to))) {
    points.push_back(height_.point(i % height_.edge, i / height_.edge));
    burden_[i] *= 0.5;
  }
  return smoothed(thinned(points));
}

void RoadNetwork::add(Road road) {
  const double half_m = road.half_width_m;
  for (std::size_t i = 0; i + 1 < road.points.size(); ++i) {
    const MapPoint a = road.points[i], b = road.points[i + 1];
    near_.add({std::min(a.e_m, b.e_m) - half_m, std::min(a.n_m, b.n_m) - half_m},
              {std::max(a.e_m, b.e_m) + half_m, std::max(a.n_m, b.n_m) + half_m}, int(segments_.size()));
    segments_.push_back({a, b, int(roads_.size())});
  }
  roads_.push_back(std::move(road));
}

RoadSight RoadNetwork::nearest(MapPoint p) const {
  RoadSight sight;
  for (const int s : near_.near(p)) {
    const Road& road = roads_[segments_[s].road];
    const double middle_m = to_segment_m(p, segments_[s].a, segments_[s].b);
    if (middle_m - road.half_width_m < sight.edge_m)
      sight = {middle_m - road.half_width_m, middle_m, road.half_width_m, road.kind};
  }
  return sight;
}

}  // namespace gigabake::sample
