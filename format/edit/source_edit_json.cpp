#include "format/edit/source_edit_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/usage_errors.h"
#include "format/edit/rings_json.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

/// Returns the metres of a member that edits of one type have, and no others; 0 for others.
double metres_of(const JsonMembers& members, const char* key, bool is_needed, const char* type) {
  const auto metres = members.number(key, -max_edit_metres, max_edit_metres);
  if (metres && !is_needed) members.fail(key, std::string("only ") + type + " has this member");
  if (!metres && is_needed) members.fail(key, "is missing; expected metres");
  return metres.value_or(0);
}

constexpr FrameKeys plane_keys{"through_m", "through_lon_lat_height"};

/// Returns the three positions of a plane; none if the member is absent.
std::vector<std::array<double, 3>> plane_of(const JsonMembers& members, const SourceEdit& edit) {
  const char* key = plane_keys.in(edit.frame);
  if (members.has(plane_keys.metres) && members.has(plane_keys.degrees))
    members.fail(key, "expected either metres or degrees, like the rings");
  if (!members.has(key)) {
    if (members.has(plane_keys.metres) || members.has(plane_keys.degrees))
      members.fail(key, "is missing: the plane and the rings need the same frame");
    return {};
  }
  if (edit.type != SourceEditType::flatten) members.fail(key, "only flatten has this member");
  const Json& list = members.array(key);
  std::vector<std::array<double, 3>> out;
  for (const Json& at : list) {
    const bool is_position =
        at.is_array() && at.size() == 3 && at[0].is_number() && at[1].is_number() && at[2].is_number();
    if (!is_position) members.fail(key, "expected three positions of three numbers");
    out.push_back({at[0].get<double>(), at[1].get<double>(), at[2].get<double>()});
    for (const double v : out.back())
      if (!(std::fabs(v) <= max_edit_metres)) members.fail(key, "expected numbers within ±1e9");
  }
  if (out.size() != 3) members.fail(key, "expected three positions of three numbers");
  const double area =
      (out[1][0] - out[0][0]) * (out[2][1] - out[0][1]) - (out[1][1] - out[0][1]) * (out[2][0] - out[0][0]);
  if (!(std::fabs(area) > 0)) members.fail(key, "its positions lie on one line, seen from above");
  return out;
}

}  // namespace

SourceEdit source_edit_of(const JsonMembers& members, MayNameSource naming) {
  members.only({"type", ring_keys.metres, ring_keys.degrees, plane_keys.metres, plane_keys.degrees, "height_m", "by_m",
                naming == MayNameSource::yes ? "source" : "type"});
  SourceEdit edit;
  edit.type = members.get<SourceEditType>("type", "inside, outside, flatten or raise");
  edit.rings = rings_of(members, edit.frame);
  edit.through = plane_of(members, edit);
  edit.height_m = metres_of(members, "height_m", edit.type == SourceEditType::flatten && edit.through.empty(),
                            edit.through.empty() ? "flatten" : "flatten without a plane");
  edit.by_m = metres_of(members, "by_m", edit.type == SourceEditType::raise, "raise");
  edit.file = members.file(), edit.key = members.path();
  return edit;
}

namespace {

SourceEdits read_source_edits(const JsonMembers& members) {
  const Json& list = members.array("edits");
  SourceEdits edits;
  for (std::size_t i = 0; i < list.size(); ++i)
    edits.list.push_back(source_edit_of(members.element("edits", list, i), MayNameSource::no));
  return edits;
}

}  // namespace

SourceEdits source_edits_of(const JsonMembers& source) {
  return with_usage_errors([&] { return read_source_edits(source); });
}

std::string to_json(const SourceEdit& edit) {
  Json out{{"type", name_of(edit.type)}, {ring_keys.in(edit.frame), edit.rings}};
  if (!edit.through.empty()) out[plane_keys.in(edit.frame)] = edit.through;
  if (edit.type == SourceEditType::flatten && edit.through.empty()) out["height_m"] = edit.height_m;
  if (edit.type == SourceEditType::raise) out["by_m"] = edit.by_m;
  return out.dump();
}

std::string to_json(const SourceEdits& edits) {
  std::string out = "{\"edits\": [";
  for (std::size_t i = 0; i < edits.list.size(); ++i) out += (i == 0 ? "" : ",\n") + to_json(edits.list[i]);
  return out + "]}\n";
}

SourceEdits source_edits_from_json(const std::filesystem::path& file, std::string_view text) {
  return with_usage_errors([&] {
    const Json json = parse_json_object(file, text);
    return read_source_edits(JsonMembers(file, json));
  });
}

}  // namespace gigabake
