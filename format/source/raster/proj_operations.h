/// Transformations of PROJ between two coordinate systems, and the grids that they need.
#pragma once

#include <array>
#include <filesystem>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <vector>

namespace gigabake {

/// West, south, east and north in degrees.
using LonLatBounds = std::array<double, 4>;

/// The transformation that PROJ prefers in an area.
struct UsedTransformation {
  std::vector<std::filesystem::path> grids;  ///< absolute paths
  double accuracy_m = -1;                    ///< negative: unknown
};

/// Returns the transformation that PROJ prefers among those whose grids are installed. Never a ballpark transformation.
/// Returns nullopt if there is none.
std::optional<UsedTransformation> used_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                                                      const LonLatBounds& area);

/// Returns the reason why PROJ has no transformation in an area; without an area, on the whole earth.
/// The text continues a sentence about `from`: "needs the grid …" with the origin of the grid, or "has no …".
std::string why_no_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                                  const std::optional<LonLatBounds>& area = std::nullopt);

}  // namespace gigabake
