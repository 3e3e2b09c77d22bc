#include "viewer/live/edit_brush.h"

#include <nlohmann/json.hpp>

namespace gigabake {
namespace {

using Json = nlohmann::json;

Json shape_of(const EditBrush& brush, const Point<Scene>& at) {
  const double r = brush.radius_m, low = at.z - brush.height_m / 2, high = at.z + brush.height_m / 2;
  if (brush.shape == 0) return {{"position_m", {at.x, at.y, at.z}}, {"radius_m", r}};
  if (brush.shape == 1) return {{"min_m", {at.x - r, at.y - r, low}}, {"max_m", {at.x + r, at.y + r, high}}};
  return {{"position_m", {at.x, at.y, low}}, {"radius_m", r}, {"height_m", brush.height_m}};
}

}  // namespace

std::string edits_of(const EditBrush& brush, const Point<Scene>& at) {
  Json edit{{"type", brush_types.at(brush.type)}, {brush_shapes.at(brush.shape), shape_of(brush, at)}};
  if (brush.type != 0) edit["rgb"] = brush.rgb;
  return Json{{"edits", Json::array({edit})}}.dump();
}

}  // namespace gigabake
