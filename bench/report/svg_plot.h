/// A plot of named points, as SVG.
#pragma once

#include <string>
#include <vector>

namespace gigabake::bench {

struct PlotPoint {
  double x = 0, y = 0;
  std::string name;
};

struct PlotSeries {
  std::string name;
  std::string colour;  ///< as SVG writes it
  std::vector<PlotPoint> points;
};

/// Both axes are better towards 0, and start there. Points that no other point beats on both are joined by a line.
struct Plot {
  std::string title, x_axis, y_axis;
  std::vector<PlotSeries> series;
};

/// Exact  Equal plots give equal text. Range  finite points, x and y ≥ 0.
std::string to_svg(const Plot& plot);

/// The points that no other one beats on both axes, by x.
std::vector<PlotPoint> best_of(const Plot& plot);

}  // namespace gigabake::bench
