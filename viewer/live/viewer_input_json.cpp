#include "viewer/live/viewer_input_json.h"

#include <nlohmann/json.hpp>

#include "format/system/json/json_members.h"
#include "viewer/pictures/frame_stats_json.h"

namespace gigabake {
namespace {

constexpr double max_requested_edge = 1 << 15;
/// The first and the last Julian day for which sun_at() is valid.
constexpr double first_julian_day = 2415020.5, last_julian_day = 2488434.5;

CameraPose pose_of(const std::array<double, 6>& v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }

nlohmann::ordered_json coordinates_json(const Point<Scene>& p) { return {p.x, p.y, p.z}; }

}  // namespace

ViewerInput viewer_input_from_json(std::string_view text) {
  const std::filesystem::path file = "steering";
  const nlohmann::json json = parse_json_object(file, text);
  const JsonMembers members(file, json, "", JsonNull::refused);
  members.only({"turn", "pan", "zoom", "home", "walk", "swing", "pose", "style", "mode", "pixel_error", "sun", "time",
                "shadows", "level_blend", "upload_ms", "size"});
  ViewerInput out;
  out.turn = members.numbers<2>("turn", -max_heights, max_heights).value_or(out.turn);
  out.pan = members.numbers<2>("pan", -max_heights, max_heights).value_or(out.pan);
  out.zoom = members.number("zoom", -max_notches, max_notches).value_or(0);
  out.home = members.find<bool>("home").value_or(false);
  out.walk = members.numbers<3>("walk", -1, 1);
  out.swing = members.numbers<2>("swing", -1, 1);
  if (const auto pose = members.numbers<6>("pose", -max_coordinate_m, max_coordinate_m)) out.pose = pose_of(*pose);
  out.style = members.find<CameraController::Style>("style");
  out.mode = members.find<ViewMode>("mode");
  out.pixel_error = members.number("pixel_error", finest_pixel_error, coarsest_pixel_error);
  out.sun = members.numbers<2>("sun", -360, 360);
  out.time = members.number("time", first_julian_day, last_julian_day);
  out.shadows = members.find<Shadows>("shadows");
  out.level_blend = members.find<LevelBlend>("level_blend");
  if (const auto upload_ms = members.number("upload_ms", 0.1, 1000)) out.upload_s = *upload_ms / 1000;
  if (const auto size = members.numbers<2>("size", 1, max_requested_edge))
    out.size = {int((*size)[0]), int((*size)[1])};
  return out;
}

std::string to_json(const ViewerState& state, const LiveFrame* frame) {
  const View& view = state.full_view;
  nlohmann::ordered_json json{{"scene", state.has_scene},
                              {"watching", state.is_watching},
                              {"problem", state.problem},
                              {"problems", state.problems},
                              {"uploads", state.uploads},
                              {"resting", state.resting},
                              {"drawn", state.drawn},
                              {"eye", coordinates_json(state.pose.eye_m)},
                              {"target", coordinates_json(state.pose.target_m)},
                              {"fovy_deg", view.camera.fovy_deg},
                              {"size", {view.camera.width, view.camera.height}},
                              {"style", name_of(state.style)},
                              {"mode", name_of(view.mode)},
                              {"pixel_error", view.camera.pixel_error},
                              {"sun", {view.sun.azimuth_deg, view.sun.elevation_deg}},
                              {"has_place", state.has_place},
                              {"shadows", name_of(view.shadows)},
                              {"level_blend", name_of(view.level_blend)},
                              {"upload_ms", state.upload_s * 1000},
                              {"speed_m_per_s", state.speed_m_per_s},
                              {"frame", nullptr}};
  if (frame) {
    json["frame"] = {{"number", frame->number},
                     {"size", {frame->frame.picture.width, frame->frame.picture.height}},
                     {"full", frame->full},
                     {"frames_per_s", frame->frames_per_s},
                     {"stats", to_json(frame->frame.stats)}};
  }
  // Invalid UTF-8 is replaced instead of causing an exception, because a path in a message may contain it.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string to_json(const std::optional<PickedPoint>& point) {
  if (!point) return R"({"point":null})";
  nlohmann::ordered_json json{{"scene", coordinates_json(point->at_m)}, {"distance_m", point->distance_m}};
  if (const auto& place = point->place)
    json["lat_lon_height"] = {place->latitude_deg, place->longitude_deg, place->height_m};
  return nlohmann::ordered_json{{"point", json}}.dump();
}

std::string to_json(const std::optional<CellFacts>& facts) {
  if (!facts) return R"({"cell":null})";
  const nlohmann::ordered_json json{{"name", facts->name},     {"state", name_of(facts->state)},
                                    {"tiles", facts->tiles},   {"triangles", facts->triangles},
                                    {"cost", facts->cost},     {"seconds", facts->seconds},
                                    {"voxels", facts->voxels}, {"error", facts->error}};
  return nlohmann::ordered_json{{"cell", json}}.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace gigabake
