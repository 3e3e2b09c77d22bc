// Readers of the viewer's input: camera paths that people write, and messages of browsers.
#include <cmath>
#include <string_view>

#include "tests/fuzz/readers.h"
#include "viewer/live/camera_path.h"
#include "viewer/live/render_scheduler.h"
#include "viewer/live/viewer_input_json.h"
#include "viewer/web/http_guard.h"

namespace gigabake::fuzz {
namespace {

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return line;
}

bool is_finite(const Point<Scene>& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

void camera_path(Bytes bytes) {
  const CameraPath path = camera_path_from_json("path.json", text_of(bytes), Geodetic{46.5, 8.25, 1200});
  for (int i = -1; i <= 9; ++i) path.at(path.first_s() + (path.last_s() - path.first_s()) * i / 8, {});
  if (!(camera_path_from_json("again.json", to_json(path), std::nullopt) == path))
    throw FaultFound("a path that was written is another one");
}

void steering(Bytes bytes) {
  CameraOptions home;
  home.eye_m = {100, -100, 50};
  home.target_m = {0, 0, 0};
  RenderScheduler scheduler(home, 0.03);
  std::string_view rest = text_of(bytes);
  for (double now_s = 0; !rest.empty(); now_s += 0.05) {
    scheduler.steer(viewer_input_from_json(take_line(rest)), now_s);
    scheduler.next(now_s);
    const CameraPose& pose = scheduler.controller().pose();
    if (!is_finite(pose.eye_m) || !is_finite(pose.target_m)) throw FaultFound("the camera is nowhere");
  }
}

void http_head(Bytes bytes) {
  std::string_view rest = text_of(bytes);
  RequestHead head;
  for (std::string* const member : {&head.method, &head.host, &head.origin, &head.content_type, &head.content_length})
    *member = take_line(rest);
  for (const bool local : {false, true}) refusal_of(head, local);
  is_loopback(host_of(head.host));
  is_token(cookie(rest, "gigabake"));
}

}  // namespace gigabake::fuzz
