#include "format/edit/edit_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "format/area/polygon.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

constexpr double max_longitude = full_turn_degrees;
/// Max absolute metres, so that a coordinate fits the lattice of any voxel size above a nanometre.
constexpr double max_metres = max_area_coordinate;
constexpr double max_colour = 255;

/// Names of the members that hold the coordinates of a shape, in metres and in degrees.
struct FrameKeys {
  const char* metres;
  const char* degrees;
};

/// Returns the frame of the only given member of the two.
EditFrame frame_of(const JsonMembers& shape, const FrameKeys& keys) {
  if (shape.has(keys.metres) == shape.has(keys.degrees))
    throw InputError(shape.file(), shape.path(), std::string("expected either ") + keys.metres + " or " + keys.degrees);
  return shape.has(keys.degrees) ? EditFrame::degrees : EditFrame::scene;
}

std::array<double, 3> position(const JsonMembers& shape, const FrameKeys& keys, EditFrame frame) {
  const char* key = frame == EditFrame::degrees ? keys.degrees : keys.metres;
  const auto at = shape.numbers<3>(key, -max_metres, max_metres);
  if (!at) shape.fail(key, "is missing");
  if (frame == EditFrame::degrees &&
      (std::fabs((*at)[0]) > max_longitude || std::fabs((*at)[1]) > max_latitude_degrees))
    shape.fail(key, "expected degrees of longitude (±360) and latitude (±90), and metres, in this order");
  return *at;
}

double positive(const JsonMembers& shape, const char* key) {
  const auto value = shape.number(key, 0, max_metres);
  if (!value || *value == 0) shape.fail(key, "expected a positive number of metres");
  return *value;
}

BoxShape box_of(const JsonMembers& shape, EditFrame& frame) {
  constexpr FrameKeys low{"min_m", "min_lon_lat_height"}, high{"max_m", "max_lon_lat_height"};
  shape.only({low.metres, low.degrees, high.metres, high.degrees});
  frame = frame_of(shape, low);
  BoxShape box{position(shape, low, frame), position(shape, high, frame)};
  if (frame_of(shape, high) != frame) shape.fail("", "states one corner in metres and one in degrees");
  for (std::size_t c = 0; c < 3; ++c)
    if (!(box.low[c] < box.high[c]))
      shape.fail(frame == EditFrame::degrees ? high.degrees : high.metres,
                 std::string("expected more than the other corner along ") + "xyz"[c]);
  return box;
}

constexpr FrameKeys place_keys{"position_m", "lon_lat_height"};

SphereShape sphere_of(const JsonMembers& shape, EditFrame& frame) {
  shape.only({place_keys.metres, place_keys.degrees, "radius_m"});
  frame = frame_of(shape, place_keys);
  return {position(shape, place_keys, frame), positive(shape, "radius_m")};
}

CylinderShape cylinder_of(const JsonMembers& shape, EditFrame& frame) {
  shape.only({place_keys.metres, place_keys.degrees, "radius_m", "height_m"});
  frame = frame_of(shape, place_keys);
  return {position(shape, place_keys, frame), positive(shape, "radius_m"), positive(shape, "height_m")};
}

std::array<double, 2> corner_of(const JsonMembers& shape, const std::string& key, const Json& corner, EditFrame frame) {
  const bool is_pair = corner.is_array() && corner.size() == 2 && corner[0].is_number() && corner[1].is_number();
  if (!is_pair) shape.fail(key, "expected an array of 2 numbers");
  const std::array<double, 2> at{corner[0].get<double>(), corner[1].get<double>()};
  const double max_x = frame == EditFrame::degrees ? max_longitude : max_metres,
               max_y = frame == EditFrame::degrees ? max_latitude_degrees : max_metres;
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

PrismShape prism_of(const JsonMembers& shape, EditFrame& frame) {
  constexpr FrameKeys keys{"rings_m", "rings_lon_lat"};
  shape.only({keys.metres, keys.degrees, "low_m", "high_m"});
  frame = frame_of(shape, keys);
  const char* key = frame == EditFrame::degrees ? keys.degrees : keys.metres;
  const Json& rings = shape.array(key);
  PrismShape prism;
  for (std::size_t r = 0; r < rings.size(); ++r)
    prism.rings.push_back(ring_of(shape, std::string(key) + "[" + std::to_string(r) + "]", rings[r], frame));
  if (prism.rings.empty()) shape.fail(key, "expected at least one ring");
  if (const auto fault = fault_of(fixed_rings(prism.rings))) shape.fail(key, *fault);
  prism.low_m = shape.get<double>("low_m"), prism.high_m = shape.get<double>("high_m");
  if (!(prism.low_m < prism.high_m && std::fabs(prism.low_m) <= max_metres && std::fabs(prism.high_m) <= max_metres))
    shape.fail("high_m", "expected more than low_m, both within ±1e9 metres");
  return prism;
}

EditShape shape_of(const JsonMembers& edit, EditFrame& frame) {
  int shapes = 0;
  for (const char* key : {"box", "sphere", "cylinder", "prism"}) shapes += edit.has(key) ? 1 : 0;
  if (shapes != 1)
    throw InputError(edit.file(), edit.path(), "expected exactly one shape: box, sphere, cylinder or prism");
  if (edit.has("box")) return box_of(edit.members("box"), frame);
  if (edit.has("sphere")) return sphere_of(edit.members("sphere"), frame);
  if (edit.has("cylinder")) return cylinder_of(edit.members("cylinder"), frame);
  return prism_of(edit.members("prism"), frame);
}

std::uint8_t byte_of(const JsonMembers& edit, const char* key, double value) {
  if (value != std::floor(value)) edit.fail(key, "expected whole numbers");
  return std::uint8_t(value);
}

void read_colour(const JsonMembers& edit, Edit& out) {
  const bool has_colour = out.type != EditType::carve;
  if (edit.has("rgb") != has_colour)
    edit.fail("rgb",
              has_colour ? "is missing; expected red, green and blue, 0 to 255" : "a carved voxel has no colour");
  if (edit.has("alpha") && out.type != EditType::paint) edit.fail("alpha", "only paint changes alpha");
  if (!has_colour) return;
  const auto rgb = *edit.numbers<3>("rgb", 0, max_colour);
  for (std::size_t c = 0; c < 3; ++c) out.rgb[c] = byte_of(edit, "rgb", rgb[c]);
  if (const auto alpha = edit.number("alpha", 1, max_colour)) out.alpha = byte_of(edit, "alpha", *alpha);
}

Edit edit_of(const JsonMembers& members) {
  members.only({"type", "box", "sphere", "cylinder", "prism", "rgb", "alpha"});
  Edit edit;
  edit.type = members.get<EditType>("type", "carve, fill or paint");
  edit.shape = shape_of(members, edit.frame);
  read_colour(members, edit);
  edit.file = members.file(), edit.key = members.path();
  return edit;
}

Json json_of(const BoxShape& s, bool degrees) {
  return {{degrees ? "min_lon_lat_height" : "min_m", s.low}, {degrees ? "max_lon_lat_height" : "max_m", s.high}};
}
Json json_of(const SphereShape& s, bool degrees) {
  return {{degrees ? place_keys.degrees : place_keys.metres, s.centre}, {"radius_m", s.radius_m}};
}
Json json_of(const CylinderShape& s, bool degrees) {
  return {
      {degrees ? place_keys.degrees : place_keys.metres, s.base}, {"radius_m", s.radius_m}, {"height_m", s.height_m}};
}
Json json_of(const PrismShape& s, bool degrees) {
  return {{degrees ? "rings_lon_lat" : "rings_m", s.rings}, {"low_m", s.low_m}, {"high_m", s.high_m}};
}

constexpr const char* shape_names[] = {"box", "sphere", "cylinder", "prism"};

Json json_of(const Edit& edit) {
  Json out{{"type", name_of(edit.type)}};
  out[shape_names[edit.shape.index()]] =
      std::visit([&](const auto& s) { return json_of(s, edit.frame == EditFrame::degrees); }, edit.shape);
  if (edit.type != EditType::carve) out["rgb"] = edit.rgb;
  if (edit.alpha) out["alpha"] = *edit.alpha;
  return out;
}

EditList read_edits(const JsonMembers& members) {
  const Json& list = members.array("edits");
  if (list.size() > max_edits) members.fail("edits", "expected at most " + std::to_string(max_edits) + " edits");
  EditList edits;
  edits.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) edits.push_back(edit_of(members.element("edits", list, i)));
  return edits;
}

/// Returns the result of `read`. Turns an InputError into a UsageError with the same text.
template <class Read>
EditList with_usage_errors(const Read& read) {
  try {
    return read();
  } catch (const InputError& e) {
    throw UsageError(e.what());
  }
}

}  // namespace

EditList edits_of(const JsonMembers& members) {
  return with_usage_errors([&] { return read_edits(members); });
}

EditList edits_from_json(const std::filesystem::path& file, std::string_view text) {
  return with_usage_errors([&] {
    const Json json = parse_json_object(file, text);
    const JsonMembers members(file, json);
    members.only({"edits"});
    return read_edits(members);
  });
}

std::string to_json(const Edit& edit) { return json_of(edit).dump(); }

std::string to_json(const EditList& edits) {
  std::string out = "{\"edits\": [";
  for (std::size_t i = 0; i < edits.size(); ++i) out += (i == 0 ? "\n  " : ",\n  ") + to_json(edits[i]);
  return out + "\n]}\n";
}

Hash128 hash_of(const Edit& edit) {
  const std::string text = to_json(edit);
  return hash_of_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void refuse(const Edit& edit, const std::string& message) {
  throw UsageError(InputError(edit.file, edit.key, message).what());
}

}  // namespace gigabake
