/// Edits of a source before its triangles become voxels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "format/edit/edit.h"

namespace gigabake {

enum class SourceEditType : std::uint8_t {
  inside,   ///< keeps the part of the surface inside the polygon
  outside,  ///< keeps the part outside
  flatten,  ///< moves the part inside to one height, or to a plane
  raise,    ///< moves the part inside up by a distance
};
template <>
constexpr auto names_of<SourceEditType>() {
  return std::to_array<std::string_view>({"inside", "outside", "flatten", "raise"});
}

/// An edit by a polygon with holes, at all heights.
struct SourceEdit {
  SourceEditType type = SourceEditType::inside;
  EditFrame frame = EditFrame::scene;
  std::vector<PrismShape::Ring> rings;  ///< the outer ring first; without repeated last positions
  double height_m = 0;                  ///< of flatten: z of the scene, or above the WGS84 ellipsoid
  /// Three positions of a plane that replaces `height_m` of flatten, in the frame of the rings; empty without one.
  std::vector<std::array<double, 3>> through = {};
  double by_m = 0;                  ///< of raise: a distance along z of the scene; negative lowers
  std::filesystem::path file = {};  ///< where the edit is listed, for messages
  std::string key = {};             ///< its key in the file, such as "sources[0].edits[3]"
};

/// The edits of a source, in their order.
struct SourceEdits {
  std::vector<SourceEdit> list;
};

}  // namespace gigabake
