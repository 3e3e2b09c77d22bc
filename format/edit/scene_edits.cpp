#include "format/edit/scene_edits.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/usage_errors.h"
#include "format/edit/edit_json.h"
#include "format/edit/source_edit_json.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

bool is_of_source(const JsonMembers& edit) {
  constexpr auto names = names_of<SourceEditType>();
  const auto type = edit.get<std::string>("type");
  return std::find(names.begin(), names.end(), type) != names.end();
}

SceneEdit scene_edit_of(const JsonMembers& members) {
  if (!is_of_source(members)) return edit_of(members);
  NamedSourceEdit out{source_edit_of(members, MayNameSource::yes), members.find<std::string>("source").value_or("")};
  if (members.contains("source") && out.source.empty()) members.fail("source", "expected the path of a source");
  return out;
}

}  // namespace

EditList voxel_edits(const SceneEditList& list) {
  EditList out;
  for (const SceneEdit& edit : list)
    if (const auto* of_voxels = std::get_if<Edit>(&edit)) out.push_back(*of_voxels);
  return out;
}

NamedSourceEdits source_edits(const SceneEditList& list) {
  NamedSourceEdits out;
  for (const SceneEdit& edit : list)
    if (const auto* of_source = std::get_if<NamedSourceEdit>(&edit)) out.push_back(*of_source);
  return out;
}

const std::string& key_of(const SceneEdit& edit) {
  if (const auto* of_voxels = std::get_if<Edit>(&edit)) return of_voxels->key;
  return std::get<NamedSourceEdit>(edit).edit.key;
}

SceneEditList scene_edits_from_json(const std::filesystem::path& file, std::string_view text) {
  return with_usage_errors([&] {
    const Json json = parse_json_object(file, text);
    const JsonMembers members(file, json);
    members.only({"edits"});
    const Json& list = members.array("edits");
    if (list.size() > max_edits) members.fail("edits", "expected at most " + std::to_string(max_edits) + " edits");
    SceneEditList edits;
    for (std::size_t i = 0; i < list.size(); ++i) edits.push_back(scene_edit_of(members.element("edits", list, i)));
    return edits;
  });
}

std::string to_json(const SceneEdit& edit) {
  if (const auto* of_voxels = std::get_if<Edit>(&edit)) return to_json(*of_voxels);
  const NamedSourceEdit& named = std::get<NamedSourceEdit>(edit);
  Json json = Json::parse(to_json(named.edit));
  if (!named.source.empty()) json["source"] = named.source;
  return json.dump();
}

std::string to_json(const SceneEditList& list) {
  std::string out = "{\"edits\": [";
  for (std::size_t i = 0; i < list.size(); ++i) out += (i == 0 ? "\n  " : ",\n  ") + to_json(list[i]);
  return out + "\n]}\n";
}

void refuse(const NamedSourceEdit& edit, const std::string& message) {
  throw UsageError(InputError(edit.edit.file, edit.edit.key, message).what());
}

}  // namespace gigabake
