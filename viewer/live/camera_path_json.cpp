#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "core/math/georeference.h"
#include "format/system/json/json_members.h"
#include "format/system/read_file.h"
#include "viewer/live/camera_controller.h"
#include "viewer/live/camera_path.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_path_file_bytes = std::uint64_t(1) << 24;
constexpr double max_time_s = 1e6;

/// The coordinate system of the triples in a file. `geographic` means the same as `lat_lon_height`.
enum class Coordinates { scene, lat_lon_height, geographic };

}  // namespace

template <>
constexpr auto names_of<Coordinates>() {
  return std::to_array<std::string_view>({"scene", "lat_lon_height", "geographic"});
}

namespace {

/// A converter of a file's coordinate triples to scene coordinates.
class CoordinateReader {
 public:
  CoordinateReader(const JsonMembers& path, const std::optional<Geodetic>& origin) {
    geographic_ = path.find<Coordinates>("coordinates").value_or(Coordinates::scene) != Coordinates::scene;
    if (!geographic_) return;
    if (!origin) path.fail("coordinates", "the scene has no position on the earth; expected scene");
    scene_from_ecef_ = scene_from_ecef(*origin);
  }

  Point<Scene> required(const JsonMembers& key, const char* name) const {
    const auto v = key.numbers<3>(name, -max_coordinate_m, max_coordinate_m);
    if (!v)
      key.fail(name, geographic_ ? "is missing; expected [latitude, longitude, height]"
                                 : "is missing; expected [x, y, z] in scene metres");
    if (!geographic_) return {(*v)[0], (*v)[1], (*v)[2]};
    if (std::fabs((*v)[0]) > 90 || std::fabs((*v)[1]) > 360)
      key.fail(name, "expected [latitude, longitude, height]; latitude is within ±90°, longitude within ±360°");
    return scene_from_ecef_(ecef_of({(*v)[0], (*v)[1], (*v)[2]}));
  }

 private:
  bool geographic_ = false;
  Affine<Scene, Ecef> scene_from_ecef_;
};

CameraKeyframe read_keyframe(const JsonMembers& json, const CoordinateReader& places) {
  json.only({"time_s", "eye", "target", "fovy_deg", "up"});
  CameraKeyframe key;
  const auto time_s = json.number("time_s", -max_time_s, max_time_s);
  if (!time_s) json.fail("time_s", "is missing; expected seconds");
  key.time_s = *time_s;
  key.pose.eye_m = places.required(json, "eye");
  key.pose.target_m = places.required(json, "target");
  key.fovy_deg = json.number("fovy_deg", 0.01, 170);
  if (const auto up = json.numbers<3>("up", -max_coordinate_m, max_coordinate_m)) {
    if (*up == std::array<double, 3>{}) json.fail("up", "expected a direction other than 0, 0, 0");
    key.up = {(*up)[0], (*up)[1], (*up)[2]};
  }
  return key;
}

nlohmann::ordered_json triple(const Point<Scene>& p) { return {p.x, p.y, p.z}; }

}  // namespace

CameraPath camera_path_from_json(const std::filesystem::path& file, std::string_view text,
                                 const std::optional<Geodetic>& origin) {
  const nlohmann::json json = parse_json_object(file, text);
  const JsonMembers path(file, json, "", JsonNull::refused);
  path.only({"coordinates", "keyframes"});
  const CoordinateReader places(path, origin);
  const nlohmann::json& list = path.array("keyframes");
  if (list.empty()) path.fail("keyframes", "expected an array of at least one keyframe");
  std::vector<CameraKeyframe> keyframes;
  for (std::size_t i = 0; i < list.size(); ++i)
    keyframes.push_back(read_keyframe(path.element("keyframes", list, i), places));
  try {
    return CameraPath(std::move(keyframes));
  } catch (const UsageError& e) {
    throw InputError(file, "", e.what());
  }
}

CameraPath read_camera_path(const std::filesystem::path& file, const std::optional<Geodetic>& origin) {
  const std::vector<std::uint8_t> text = read_whole_file(file, max_path_file_bytes);
  return camera_path_from_json(file, {reinterpret_cast<const char*>(text.data()), text.size()}, origin);
}

std::string to_json(const CameraPath& path) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const CameraKeyframe& k : path.keyframes()) {
    nlohmann::ordered_json key{
        {"time_s", k.time_s}, {"eye", triple(k.pose.eye_m)}, {"target", triple(k.pose.target_m)}};
    if (k.fovy_deg) key["fovy_deg"] = *k.fovy_deg;
    if (k.up) key["up"] = triple(*k.up);
    list.push_back(std::move(key));
  }
  return nlohmann::ordered_json{{"coordinates", "scene"}, {"keyframes", std::move(list)}}.dump(1) + "\n";
}

}  // namespace gigabake
