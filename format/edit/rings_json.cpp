#include "format/edit/rings_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"
#include "format/area/polygon.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

std::array<double, 2> corner_of(const JsonMembers& shape, const std::string& key, const Json& corner, EditFrame frame) {
  const bool is_pair = corner.is_array() && corner.size() == 2 && corner[0].is_number() && corner[1].is_number();
  if (!is_pair) shape.fail(key, "expected an array of 2 numbers");
  const std::array<double, 2> at{corner[0].get<double>(), corner[1].get<double>()};
  const double max_x = frame == EditFrame::degrees ? full_turn_degrees : max_edit_metres,
               max_y = frame == EditFrame::degrees ? max_latitude_degrees : max_edit_metres;
  if (!(std::fabs(at[0]) <= max_x && std::fabs(at[1]) <= max_y))
    shape.fail(key, frame == EditFrame::degrees ? "expected degrees of longitude (±360) and latitude (±90)"
                                                : "expected metres within ±1e9");
  return at;
}

PrismShape::Ring ring_of(const JsonMembers& shape, const std::string& key, const Json& corners, EditFrame frame) {
  if (!corners.is_array()) shape.fail(key, "expected an array of positions");
  PrismShape::Ring ring;
  for (std::size_t i = 0; i < corners.size(); ++i)
    ring.push_back(corner_of(shape, key + "[" + std::to_string(i) + "]", corners[i], frame));
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) shape.fail(key, "expected at least three positions");
  return ring;
}

/// Returns rings whose coordinates are rounded to 2^-30 metres or degrees, for the check of their order.
std::vector<Ring> fixed_rings(const std::vector<PrismShape::Ring>& rings) {
  std::vector<Ring> out;
  for (const PrismShape::Ring& ring : rings) {
    out.emplace_back();
    for (const auto& at : ring) out.back().push_back({to_fixed(at[0]), to_fixed(at[1])});
  }
  return out;
}

}  // namespace

EditFrame frame_of(const JsonMembers& shape, const FrameKeys& keys) {
  if (shape.has(keys.metres) == shape.has(keys.degrees))
    throw InputError(shape.file(), shape.path(), std::string("expected either ") + keys.metres + " or " + keys.degrees);
  return shape.has(keys.degrees) ? EditFrame::degrees : EditFrame::scene;
}

std::vector<PrismShape::Ring> rings_of(const JsonMembers& shape, EditFrame& frame) {
  frame = frame_of(shape, ring_keys);
  const char* key = ring_keys.in(frame);
  const Json& list = shape.array(key);
  std::vector<PrismShape::Ring> rings;
  for (std::size_t r = 0; r < list.size(); ++r)
    rings.push_back(ring_of(shape, std::string(key) + "[" + std::to_string(r) + "]", list[r], frame));
  if (rings.empty()) shape.fail(key, "expected at least one ring");
  if (const auto fault = fault_of(fixed_rings(rings))) shape.fail(key, *fault);
  return rings;
}

}  // namespace gigabake
