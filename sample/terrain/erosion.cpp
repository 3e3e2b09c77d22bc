#include "sample/terrain/erosion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

namespace gigabake::sample {
namespace {

struct Neighbour {
  int dx, dy;
  double steps;  ///< distance in cells
};
const std::array<Neighbour, 8> neighbours{{{-1, -1, std::sqrt(2.0)},
                                           {0, -1, 1},
                                           {1, -1, std::sqrt(2.0)},
                                           {-1, 0, 1},
                                           {1, 0, 1},
                                           {-1, 1, std::sqrt(2.0)},
                                           {0, 1, 1},
                                           {1, 1, std::sqrt(2.0)}}};

/// The direction in which every point drains, and an order in which receivers precede the points that drain to them.
struct Drainage {
  std::vector<int> order, rank, receiver;  ///< receiver: the neighbour with the steepest descent; -1 in the base
  std::vector<double> receiver_steps;
  std::vector<double> filled;  ///< heights with every hollow filled to its outlet
};

struct Flood {
  double height;
  int index;
  bool operator<(const Flood& o) const { return height != o.height ? height > o.height : index > o.index; }
};

template <class Visit>
void for_neighbours(int edge, int index, Visit&& visit) {
  const int x = index % edge, y = index / edge;
  for (const Neighbour& k : neighbours) {
    const int nx = x + k.dx, ny = y + k.dy;
    if (nx >= 0 && ny >= 0 && nx < edge && ny < edge) visit(ny * edge + nx, k.steps);
  }
}

/// Computes the drainage by priority flood: the flood grows upwards from the base through the lowest outlet of every
/// hollow.
void flood(const Raster& height, const std::vector<std::uint8_t>& base, Drainage& d) {
  d.filled = height.v;
  d.rank.assign(height.v.size(), 0);
  std::vector<std::uint8_t> seen(base);
  std::priority_queue<Flood> front;
  for (int i = 0; i < int(base.size()); ++i)
    if (base[i]) front.push({height.v[i], i});
  while (!front.empty()) {
    const int i = front.top().index;
    front.pop();
    d.rank[i] = int(d.order.size());
    d.order.push_back(i);
    for_neighbours(height.edge, i, [&](int j, double) {
      if (seen[j]) return;
      seen[j] = 1;
      d.filled[j] = std::max(height.v[j], d.filled[i]);
      front.push({d.filled[j], j});
    });
  }
}

Drainage drain(const Raster& height, const std::vector<std::uint8_t>& base) {
  Drainage d;
  flood(height, base, d);
  d.receiver.assign(height.v.size(), -1);
  d.receiver_steps.assign(height.v.size(), 1);
  for (int i = 0; i < int(base.size()); ++i) {
    double steepest = -1;
    for_neighbours(height.edge, i, [&](int j, double steps) {
      const double slope = (d.filled[i] - d.filled[j]) / steps;
      if (base[i] || d.rank[j] > d.rank[i] || slope <= steepest) return;
      steepest = slope;
      d.receiver[i] = j;
      d.receiver_steps[i] = steps;
    });
  }
  return d;
}

/// Returns the drained area. Each point divides its water among all lower neighbours by slope. Water therefore forms a
/// thin layer on slopes, and streams in hollows.
Raster drained_area(const Raster& height, const Drainage& d) {
  Raster area = height;
  std::fill(area.v.begin(), area.v.end(), height.cell_m * height.cell_m);
  for (auto it = d.order.rbegin(); it != d.order.rend(); ++it) {
    const int i = *it;
    if (d.receiver[i] < 0) continue;
    double total = 0;
    const auto share = [&](int j, double steps) {
      const double slope = d.rank[j] < d.rank[i] ? (d.filled[i] - d.filled[j]) / steps : 0;
      return slope * std::sqrt(slope);
    };
    for_neighbours(height.edge, i, [&](int j, double steps) { total += share(j, steps); });
    if (total <= 0)
      area.v[d.receiver[i]] += area.v[i];
    else
      for_neighbours(height.edge, i, [&](int j, double steps) { area.v[j] += area.v[i] * share(j, steps) / total; });
  }
  return area;
}

/// Performs one implicit step of stream erosion. It begins at the base, so that the receiver's new height is known.
void cut(Raster& height, const Raster& area, const Drainage& d, const ErosionOptions& options) {
  for (const int i : d.order) {
    const int receiver = d.receiver[i];
    if (receiver < 0) continue;
    const double channel_m2 = std::max(0.0, area.v[i] - options.gully_m2);
    const double f = options.stream_power * std::sqrt(channel_m2) / (d.receiver_steps[i] * height.cell_m);
    const double low = height.v[receiver];
    if (height.v[i] > low) height.v[i] = (height.v[i] + f * low) / (1 + f);
  }
}

/// Moves ground steeper than the talus to the lower side, and moves soil towards the mean of its neighbours.
void slump(Raster& height, const std::vector<std::uint8_t>& base, const ErosionOptions& options) {
  const double step_m = options.talus * height.cell_m;
  std::vector<double> change(height.v.size(), 0.0);
  const auto settle = [&](int i, int j) {
    const double drop = height.v[i] - height.v[j];
    double moved = 0.25 * options.creep * drop;
    if (drop > step_m) moved += 0.12 * (drop - step_m);
    if (drop < -step_m) moved += 0.12 * (drop + step_m);
    change[i] -= moved;
    change[j] += moved;
  };
  for (int y = 0; y < height.edge; ++y)
    for (int x = 0; x < height.edge; ++x) {
      const int i = y * height.edge + x;
      if (x + 1 < height.edge) settle(i, i + 1);
      if (y + 1 < height.edge) settle(i, i + height.edge);
    }
  for (std::size_t i = 0; i < change.size(); ++i)
    if (!base[i]) height.v[i] += change[i];
}

}  // namespace

Raster erode(Raster& height, const Raster& uplift_m, const std::vector<std::uint8_t>& base,
             const ErosionOptions& options) {
  for (int step = 0; step < options.steps; ++step) {
    for (std::size_t i = 0; i < height.v.size(); ++i)
      if (!base[i]) height.v[i] += uplift_m.v[i] / options.steps;
    const Drainage d = drain(height, base);
    cut(height, drained_area(height, d), d, options);
    slump(height, base, options);
    slump(height, base, options);
  }
  return drained_area(height, drain(height, base));
}

}  // namespace gigabake::sample
