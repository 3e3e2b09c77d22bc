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
  std::string colour;  ///< an SVG colour
  std::vector<PlotPoint> points;
};

/// A plot in which smaller is better on both axes; both start at 0. A line joins the points of the Pareto front.
struct Plot {
  std::string title, x_axis, y_axis;
  std::vector<PlotSeries> series;
};

/// Returns the plot as SVG.
/// Exact   Equal plots give equal text.
/// Range   Points are finite, x and y ≥ 0.
std::string to_svg(const Plot& plot);

/// Returns the Pareto front, the points that no other point beats on both axes, in order of x.
std::vector<PlotPoint> best_of(const Plot& plot);

}  // namespace gigabake::bench
