#include "bench/hard/surfaces/surface_bounds.h"

#include <algorithm>

namespace gigabake::bench {
namespace {

/// The bound of a value that does not meet its goal.
struct ReachedBound {
  const char *scene, *name;
  double value;
};

/// Lower a value when a change improves it; never raise one.
constexpr ReachedBound reached[] = {
    {"town", "area at 1", 1.2},
    {"town", "area at 4", 1.23},
    {"town", "area at 16", 2.15},
    {"wires-0.1", "area at 1", 13.7},
    {"wires-0.1", "area at 4", 15.3},
    {"wires-0.1", "area at 16", 14.7},
    {"wires-0.3", "area at 1", 5.63},
    {"wires-0.3", "area at 4", 7.17},
    {"wires-0.3", "area at 16", 6.47},
    {"wires-1", "area at 1", 2.4},
    {"wires-1", "area at 4", 3.16},
    {"wires-1", "area at 16", 2.76},
    {"sheet-leaves-0.1", "area at 1", 23.3},
    {"sheet-leaves-0.1", "area at 4", 25.1},
    {"sheet-leaves-0.1", "area at 16", 32.5},
    {"sheet-leaves-0.3", "area at 1", 19},
    {"sheet-leaves-0.3", "area at 4", 22.7},
    {"sheet-leaves-0.3", "area at 16", 29},
    {"sheet-leaves-1", "area at 1", 6.5},
    {"sheet-leaves-1", "area at 4", 7.83},
    {"sheet-leaves-1", "area at 16", 11},
    {"solid-leaves-0.1", "area at 1", 19.5},
    {"solid-leaves-0.1", "area at 4", 21},
    {"solid-leaves-0.1", "area at 16", 27.2},
    {"solid-leaves-0.3", "area at 1", 16.4},
    {"solid-leaves-0.3", "area at 4", 19.3},
    {"solid-leaves-0.3", "area at 16", 23.6},
    {"solid-leaves-1", "area at 1", 7.4},
    {"solid-leaves-1", "area at 4", 9.5},
    {"solid-leaves-1", "area at 16", 9.3},
};

}  // namespace

HardFigure bounded(const std::string& scene, const std::string& name, const std::string& unit, double measured,
                   const HardRange& goal) {
  HardFigure figure{name, unit, measured, goal.high, goal, goal.low};
  for (const ReachedBound& bound : reached) {
    if (scene != bound.scene || name != bound.name) continue;
    figure.bound = std::max(goal.high, bound.value);
    figure.at_least = std::min(goal.low, bound.value);
  }
  return figure;
}

}  // namespace gigabake::bench
