#include "viewer/pictures/frame_stats_json.h"

namespace gigabake {

nlohmann::ordered_json to_json(const FrameStats& s) {
  nlohmann::ordered_json json{
      {"cast_s", s.cast_s},         {"upload_s", s.upload_s},     {"total_s", s.total_s},
      {"wanted", s.requested},      {"uploads", s.uploads},       {"pages_loading", s.pages_loading},
      {"passes", s.passes},         {"page_waits", s.page_waits}, {"files_opened", s.files_opened},
      {"bytes_held", s.bytes_held}, {"bytes_allowed", nullptr},   {"complete", s.complete}};
  if (s.bytes_allowed != UINT64_MAX) json["bytes_allowed"] = s.bytes_allowed;
  return json;
}

}  // namespace gigabake
