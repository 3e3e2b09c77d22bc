#include "format/edit/edit_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "core/base/error.h"
#include "core/base/usage_errors.h"
#include "core/octree/octree.h"
#include "format/area/fixed_point.h"
#include "format/edit/rings_json.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

constexpr double max_colour = 255;

std::array<double, 3> position(const JsonMembers& shape, const FrameKeys& keys, EditFrame frame) {
  const char* key = keys.in(frame);
  const auto at = shape.numbers<3>(key, -max_edit_metres, max_edit_metres);
  if (!at) shape.fail(key, "is missing");
  if (frame == EditFrame::degrees &&
      (std::fabs((*at)[0]) > full_turn_degrees || std::fabs((*at)[1]) > max_latitude_degrees))
    shape.fail(key, "expected degrees of longitude (±360) and latitude (±90), and metres, in this order");
  return *at;
}

double positive(const JsonMembers& shape, const char* key) {
  const auto value = shape.number(key, 0, max_edit_metres);
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

PrismShape prism_of(const JsonMembers& shape, EditFrame& frame) {
  shape.only({ring_keys.metres, ring_keys.degrees, "low_m", "high_m"});
  PrismShape prism;
  prism.rings = rings_of(shape, frame);
  prism.low_m = shape.get<double>("low_m"), prism.high_m = shape.get<double>("high_m");
  if (!(prism.low_m < prism.high_m && std::fabs(prism.low_m) <= max_edit_metres &&
        std::fabs(prism.high_m) <= max_edit_metres))
    shape.fail("high_m", "expected more than low_m, both within ±1e9 metres");
  return prism;
}

/// Returns the triples of numbers in an array. `limit` bounds their magnitude.
template <class Number>
std::vector<std::array<Number, 3>> triples(const JsonMembers& shape, const char* key, double low, double high) {
  const Json& list = shape.array(key);
  std::vector<std::array<Number, 3>> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::array<Number, 3>& triple = out.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const Json* value = list[i].is_array() && list[i].size() == 3 ? &list[i][c] : nullptr;
      const bool is_number =
          value != nullptr && (std::is_integral_v<Number> ? value->is_number_integer() : value->is_number());
      const double number = is_number ? value->get<double>() : NAN;
      if (!(number >= low && number <= high))
        shape.fail(std::string(key) + "[" + std::to_string(i) + "]", std::is_integral_v<Number>
                                                                         ? "expected three indices of positions"
                                                                         : "expected three numbers of metres");
      triple[c] = Number(number);
    }
  }
  if (out.empty()) shape.fail(key, "is missing or empty");
  return out;
}

/// Returns the mesh of a file, which is moved to `position_m`, or which `lon_lat_height` places.
MeshShape mesh_of_file(const JsonMembers& shape, EditFrame& frame, const ShapeMeshReader& reader) {
  shape.only({"path", "up", place_keys.metres, place_keys.degrees});
  if (!reader) shape.fail("path", "mesh files are named in a scene .json only; list positions_m and triangles");
  frame = frame_of(shape, place_keys);
  const std::array<double, 3> place = position(shape, place_keys, frame);
  MeshShape mesh = reader(shape);
  if (frame == EditFrame::degrees) mesh.place = place;
  for (auto& p : mesh.positions_m)
    for (std::size_t c = 0; c < 3 && frame == EditFrame::scene; ++c) p[c] += place[c];
  return mesh;
}

MeshShape mesh_of(const JsonMembers& shape, EditFrame& frame, const ShapeMeshReader& reader) {
  if (shape.has("path")) return mesh_of_file(shape, frame, reader);
  shape.only({place_keys.degrees, "positions_m", "triangles"});
  frame = shape.has(place_keys.degrees) ? EditFrame::degrees : EditFrame::scene;
  MeshShape mesh;
  if (frame == EditFrame::degrees) mesh.place = position(shape, place_keys, frame);
  mesh.positions_m = triples<double>(shape, "positions_m", -max_edit_metres, max_edit_metres);
  mesh.triangles = triples<std::uint32_t>(shape, "triangles", 0, double(mesh.positions_m.size()) - 1);
  return mesh;
}

constexpr const char* shape_names[] = {"box", "sphere", "cylinder", "prism", "mesh"};

EditShape shape_of(const JsonMembers& edit, EditFrame& frame, const ShapeMeshReader& reader) {
  int shapes = 0;
  for (const char* key : shape_names) shapes += edit.has(key) ? 1 : 0;
  if (shapes != 1)
    throw InputError(edit.file(), edit.path(), "expected exactly one shape: box, sphere, cylinder, prism or mesh");
  if (edit.has("mesh")) return mesh_of(edit.members("mesh"), frame, reader);
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
  const bool is_carve = out.type == EditType::carve;
  if (is_carve && edit.has("rgb")) edit.fail("rgb", "a carved voxel has no colour");
  if (is_carve && edit.has("class")) edit.fail("class", "a carved voxel has no class");
  if (edit.has("alpha") && out.type != EditType::paint) edit.fail("alpha", "only paint changes alpha");
  if (is_carve) return;
  if (const auto voxel_class = edit.number("class", 0, max_class)) {
    if (*voxel_class != std::floor(*voxel_class)) edit.fail("class", "expected a whole number");
    out.voxel_class = std::uint16_t(*voxel_class);
  }
  const auto rgb = edit.numbers<3>("rgb", 0, max_colour);
  out.has_rgb = rgb.has_value();
  if (!rgb && (out.type == EditType::fill || !out.voxel_class))
    edit.fail("rgb", "is missing; expected red, green and blue, 0 to 255");
  for (std::size_t c = 0; c < 3 && rgb; ++c) out.rgb[c] = byte_of(edit, "rgb", (*rgb)[c]);
  if (const auto alpha = edit.number("alpha", 1, max_colour)) out.alpha = byte_of(edit, "alpha", *alpha);
}

Edit edit_of(const JsonMembers& members, const ShapeMeshReader& reader) {
  members.only({"type", "box", "sphere", "cylinder", "prism", "mesh", "rgb", "alpha", "class"});
  Edit edit;
  edit.type = members.get<EditType>("type", "carve, fill or paint");
  edit.shape = shape_of(members, edit.frame, reader);
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
  return {{degrees ? ring_keys.degrees : ring_keys.metres, s.rings}, {"low_m", s.low_m}, {"high_m", s.high_m}};
}

Json json_of(const MeshShape& s, bool degrees) {
  Json out = {{"positions_m", s.positions_m}, {"triangles", s.triangles}};
  if (degrees) out[place_keys.degrees] = s.place;
  return out;
}

Json json_of(const Edit& edit) {
  Json out{{"type", name_of(edit.type)}};
  out[shape_names[edit.shape.index()]] =
      std::visit([&](const auto& s) { return json_of(s, edit.frame == EditFrame::degrees); }, edit.shape);
  if (edit.type != EditType::carve && edit.has_rgb) out["rgb"] = edit.rgb;
  if (edit.voxel_class) out["class"] = *edit.voxel_class;
  if (edit.alpha) out["alpha"] = *edit.alpha;
  return out;
}

EditList read_edits(const JsonMembers& members, const ShapeMeshReader& reader) {
  const Json& list = members.array("edits");
  if (list.size() > max_edits) members.fail("edits", "expected at most " + std::to_string(max_edits) + " edits");
  EditList edits;
  edits.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) edits.push_back(edit_of(members.element("edits", list, i), reader));
  return edits;
}

}  // namespace

Edit edit_of(const JsonMembers& edit) { return edit_of(edit, nullptr); }

EditList edits_of(const JsonMembers& members, const ShapeMeshReader& reader) {
  return with_usage_errors([&] { return read_edits(members, reader); });
}

EditList edits_from_json(const std::filesystem::path& file, std::string_view text) {
  return with_usage_errors([&] {
    const Json json = parse_json_object(file, text);
    const JsonMembers members(file, json);
    members.only({"edits"});
    return read_edits(members, nullptr);
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
