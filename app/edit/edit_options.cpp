#include "app/edit/edit_options.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "app/options/choices.h"
#include "app/options/text_values.h"
#include "core/base/error.h"
#include "core/octree/octree.h"
#include "format/area/geojson.h"
#include "format/edit/edit_json.h"
#include "format/edit/source_edit_json.h"
#include "format/source/shape_mesh.h"
#include "format/system/read_file.h"

namespace gigabake::app {
namespace {

constexpr const char* shape_forms =
    "box:X,Y,Z,X,Y,Z, sphere:X,Y,Z,RADIUS, cylinder:X,Y,Z,RADIUS,HEIGHT, prism:AREA.geojson,LOW,HIGH or "
    "mesh:FILE,X,Y,Z";

std::array<double, 3> position(const std::vector<double>& n, std::size_t first) {
  return {n[first], n[first + 1], n[first + 2]};
}

/// Returns the rings of the only polygon of a GeoJSON file, in degrees.
std::vector<PrismShape::Ring> rings_of_file(const char* option, const std::string& file) {
  const std::vector<AreaPolygon> polygons = read_geojson_polygons(file);
  if (polygons.size() != 1)
    throw UsageError(fmt::format("{}: expected one polygon, but '{}' has {}", option, file, polygons.size()));
  std::vector<PrismShape::Ring> rings;
  for (const Ring& ring : polygons[0].rings()) {
    rings.emplace_back();
    for (const FixedPoint& p : ring)
      rings.back().push_back({double(p.x) / fixed_per_unit, double(p.y) / fixed_per_unit});
  }
  return rings;
}

/// Returns the prism over the only polygon of a GeoJSON file. `text` is FILE,LOW,HIGH.
PrismShape prism_of(const char* option, const std::string& text) {
  const std::size_t high = text.rfind(','), low = high == std::string::npos ? high : text.rfind(',', high - 1);
  if (high == 0 || low == std::string::npos)
    throw UsageError(fmt::format("{}: expected prism:AREA.geojson,LOW,HIGH", option));
  const std::vector<double> heights = numbers(option, "LOW,HIGH", text.substr(low + 1), {2});
  return {rings_of_file(option, text.substr(0, low)), heights[0], heights[1]};
}

/// Returns the mesh of a file at a place. `text` is FILE,X,Y,Z.
MeshShape mesh_of(const char* option, const std::string& text, bool degrees, const std::optional<UpAxis>& up) {
  std::size_t comma = text.size();
  for (int i = 0; i < 3; ++i) comma = comma == 0 || comma == std::string::npos ? comma : text.rfind(',', comma - 1);
  if (comma == 0 || comma == std::string::npos) throw UsageError(fmt::format("{}: expected mesh:FILE,X,Y,Z", option));
  const std::vector<double> n = numbers(option, "X,Y,Z", text.substr(comma + 1), {3});
  MeshShape mesh = read_shape_mesh(text.substr(0, comma), up);
  if (degrees) mesh.place = position(n, 0);
  for (auto& p : mesh.positions_m)
    for (std::size_t c = 0; c < 3 && !degrees; ++c) p[c] += n[c];
  return mesh;
}

/// Sets the shape and the frame of an edit from the text of an option.
void set_shape(const char* option, const std::string& text, bool degrees, const std::optional<UpAxis>& up, Edit& edit) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon), rest = colon == std::string::npos ? "" : text.substr(colon + 1);
  edit.frame = degrees || name == "prism" ? EditFrame::degrees : EditFrame::scene;
  if (name == "box") {
    const std::vector<double> n = numbers(option, "box:X,Y,Z,X,Y,Z", rest, {6});
    edit.shape = BoxShape{position(n, 0), position(n, 3)};
  } else if (name == "sphere") {
    const std::vector<double> n = numbers(option, "sphere:X,Y,Z,RADIUS", rest, {4});
    edit.shape = SphereShape{position(n, 0), n[3]};
  } else if (name == "cylinder") {
    const std::vector<double> n = numbers(option, "cylinder:X,Y,Z,RADIUS,HEIGHT", rest, {5});
    edit.shape = CylinderShape{position(n, 0), n[3], n[4]};
  } else if (name == "prism") {
    edit.shape = prism_of(option, rest);
  } else if (name == "mesh") {
    edit.shape = mesh_of(option, rest, degrees, up);
  } else {
    throw UsageError(fmt::format("{}: expected {}; got '{}'", option, shape_forms, text));
  }
}

std::uint8_t byte_of(const char* option, double value, double minimum) {
  if (value == std::int64_t(value) && value >= minimum && value <= 255) return std::uint8_t(value);
  throw UsageError(fmt::format("{}: expected whole numbers from {} to 255", option, minimum));
}

/// Returns an edit of a source. `text` is AREA.geojson, for flatten and raise with a number of metres.
SourceEdit source_edit_of_option(SourceEditType type, const char* option, const std::string& text) {
  SourceEdit edit;
  edit.type = type;
  edit.frame = EditFrame::degrees;
  const bool has_metres = type == SourceEditType::flatten || type == SourceEditType::raise;
  const std::size_t comma = has_metres ? text.rfind(',') : text.size();
  if (comma == 0 || comma == std::string::npos)
    throw UsageError(fmt::format("{}: expected AREA.geojson,METRES", option));
  if (has_metres)
    (type == SourceEditType::flatten ? edit.height_m : edit.by_m) = number(option, text.substr(comma + 1));
  edit.rings = rings_of_file(option, text.substr(0, comma));
  return source_edits_from_json(option, to_json(SourceEdits{{edit}})).list.front();
}

VoxelClass class_of_option(const std::string& text) {
  const double value = number("--class", text);
  if (!(value >= 0 && value <= max_class) || value != std::floor(value))
    throw UsageError(fmt::format("--class: expected a whole number from 0 to {}, got '{}'", max_class, text));
  return VoxelClass(value);
}

}  // namespace

void EditOptions::add_to(CLI::App& command) {
  command.add_option("--carve", carve, fmt::format("SHAPE: remove its voxels; {}", shape_forms));
  command.add_option("--fill", fill, "SHAPE: fill it with opaque voxels of colour --rgb");
  command.add_option("--paint", paint, "SHAPE: give its voxels the colour --rgb, and --alpha if given");
  command.add_option("--inside", inside, "AREA.geojson: keep only the part of the sources inside its polygon");
  command.add_option("--outside", outside, "AREA.geojson: keep only the part outside");
  command.add_option("--flatten", flatten, "AREA.geojson,HEIGHT: move the part inside to a height above the ellipsoid");
  command.add_option("--raise", raise, "AREA.geojson,METRES: move the part inside up, or down by a negative number");
  command.add_option(
      "--source", source,
      "path of the source in the scene .json that --inside, --outside, --flatten or --raise changes (all)");
  command.add_option("--from", from, "EDITS.json: append its edits (docs/editing.md)");
  command.add_option("--rgb", rgb, "R,G,B: sRGB colour of --fill or --paint, 0 to 255");
  command.add_option("--alpha", alpha, "alpha of --paint, 1 to 255");
  command.add_option("--class", voxel_class, "class of --fill or --paint, 0 to 65535; --paint then needs no --rgb");
  add_choice(command, "--up", up, "axis of a mesh file that points up (y)");
  command.add_flag(
      "--degrees", degrees,
      "X,Y,Z of shapes are longitude, latitude and height above the WGS84 ellipsoid (default: metres of the "
      "scene's frame); a prism is always in degrees");
}

bool EditOptions::empty() const {
  const std::string* const edits[] = {&carve, &fill, &paint, &inside, &outside, &flatten, &raise, &from};
  return std::ranges::all_of(edits, [](const std::string* text) { return text->empty(); });
}

SceneEditList EditOptions::edits() const {
  SceneEditList list;
  if (!from.empty()) {
    const std::vector<std::uint8_t> bytes = read_whole_file(from);
    list = scene_edits_from_json(from, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  std::optional<Edit> of_voxels = voxel_edit();
  std::optional<NamedSourceEdit> of_source = source_edit();
  if (of_voxels && of_source)
    throw UsageError("edits of voxels and of sources exclude each other; list them in a file for --from");
  if (of_voxels) list.emplace_back(*std::move(of_voxels));
  if (of_source) list.emplace_back(*std::move(of_source));
  return list;
}

/// Returns the edit of a source that the options state.
std::optional<NamedSourceEdit> EditOptions::source_edit() const {
  const std::string* const texts[] = {&inside, &outside, &flatten, &raise};
  constexpr const char* options[] = {"--inside", "--outside", "--flatten", "--raise"};
  NamedSourceEdit out;
  out.source = source;
  bool is_given = false;
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    if (texts[i]->empty()) continue;
    if (std::exchange(is_given, true))
      throw UsageError("--inside, --outside, --flatten and --raise exclude each other; list several edits in a file");
    out.edit = source_edit_of_option(SourceEditType(i), options[i], *texts[i]);
  }
  if (is_given) return out;
  if (!source.empty()) throw UsageError("--source: only --inside, --outside, --flatten and --raise edit a source");
  return std::nullopt;
}

/// Returns the edit of voxels that the options state.
std::optional<Edit> EditOptions::voxel_edit() const {
  const int given = int(!carve.empty()) + int(!fill.empty()) + int(!paint.empty());
  if (given > 1)
    throw UsageError("--carve, --fill and --paint exclude each other; list several edits in a file for --from");
  if (carve.empty() == false && !rgb.empty()) throw UsageError("--rgb: a carved voxel has no colour");
  if ((!fill.empty() || (!paint.empty() && voxel_class.empty())) && rgb.empty())
    throw UsageError("--rgb: is missing; expected R,G,B");
  if (fill.empty() && paint.empty() && !rgb.empty()) throw UsageError("--rgb: only --fill and --paint have a colour");
  if (fill.empty() && paint.empty() && !voxel_class.empty())
    throw UsageError("--class: only --fill and --paint have a class");
  if (carve.empty() && fill.empty() && paint.empty() && degrees)
    throw UsageError("--degrees: only the shapes of --carve, --fill and --paint may be in degrees");
  if (paint.empty() && !alpha.empty()) throw UsageError("--alpha: only --paint changes alpha");
  if (given == 0) return std::nullopt;
  Edit edit;
  edit.type = !carve.empty() ? EditType::carve : (!fill.empty() ? EditType::fill : EditType::paint);
  const char* option = !carve.empty() ? "--carve" : (!fill.empty() ? "--fill" : "--paint");
  set_shape(option, !carve.empty() ? carve : (!fill.empty() ? fill : paint), degrees, up, edit);
  if (!rgb.empty()) {
    const std::vector<double> colour = numbers("--rgb", "R,G,B", rgb, {3});
    for (std::size_t c = 0; c < 3; ++c) edit.rgb[c] = byte_of("--rgb", colour[c], 0);
  }
  edit.has_rgb = !rgb.empty();
  if (!voxel_class.empty()) edit.voxel_class = class_of_option(voxel_class);
  if (!alpha.empty()) edit.alpha = byte_of("--alpha", number("--alpha", alpha), 1);
  return edits_from_json(option, to_json(EditList{edit})).front();
}

}  // namespace gigabake::app
