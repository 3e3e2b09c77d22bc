#include "format/source/classes/source_classes.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/usage_errors.h"
#include "format/edit/edit.h"
#include "format/source/source.h"

namespace gigabake {
namespace {

[[noreturn]] void refuse_member(const JsonMembers& members, std::string_view key, const std::string& message) {
  throw UsageError(InputError(members.file(), members.path_of(key), message).what());
}

/// Returns a member that is a whole number in [minimum, maximum].
std::optional<std::int64_t> whole_number(const JsonMembers& members, const std::string& key, std::int64_t minimum,
                                         std::int64_t maximum) {
  const nlohmann::json* value = members.value(key);
  if (value == nullptr) return std::nullopt;
  const double number = value->is_number() ? value->get<double>() : NAN;
  if (!(number >= double(minimum) && number <= double(maximum)) || number != std::floor(number))
    refuse_member(members, key,
                  "expected a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum));
  return std::int64_t(number);
}

ClassIds ids_in(const JsonMembers& source) {
  const JsonMembers members = source.members("class_from_ids");
  members.only({"attribute", "feature_ids", "instance_ids", "add"});
  ClassIds ids;
  ids.attribute = members.find<std::string>("attribute").value_or("");
  ids.feature_set = whole_number(members, "feature_ids", 0, max_id);
  ids.instance_set = whole_number(members, "instance_ids", 0, max_id);
  if (int(!ids.attribute.empty()) + int(ids.feature_set.has_value()) + int(ids.instance_set.has_value()) != 1)
    members.fail("attribute",
                 "expected one of: the attribute, such as _BATCHID; feature_ids, a number in EXT_mesh_features; "
                 "instance_ids, a number in EXT_instance_features");
  ids.add = whole_number(members, "add", -max_id, max_class).value_or(0);
  return ids;
}

SourceClasses classes_in(const JsonMembers& source) {
  SourceClasses classes;
  classes.file = source.file();
  classes.key = source.path();
  classes.of_source = class_in(source, "class").value_or(no_class);
  if (source.has("class_of_material")) {
    const JsonMembers materials = source.members("class_of_material");
    for (const auto& item : source.object("class_of_material").items()) {
      const auto voxel_class = whole_number(materials, item.key(), 0, max_class);
      if (!voxel_class) refuse_member(materials, item.key(), "expected a class");
      classes.of_materials.push_back({item.key(), VoxelClass(*voxel_class)});
    }
  }
  std::ranges::sort(classes.of_materials, {}, &SourceClasses::OfMaterial::name);
  if (source.has("class_from_ids")) classes.ids = ids_in(source);
  return classes;
}

}  // namespace

std::optional<std::size_t> SourceClasses::find_material(std::string_view name) const {
  const auto at = std::ranges::lower_bound(of_materials, name, {}, &OfMaterial::name);
  if (at == of_materials.end() || at->name != name) return std::nullopt;
  return std::size_t(at - of_materials.begin());
}

void SourceClasses::refuse(const std::string& member, const std::string& message) const {
  throw UsageError(InputError(file, key.empty() ? member : key + "." + member, message).what());
}

void SourceClasses::refuse_unknown(std::size_t material) const {
  refuse("class_of_material", "no material of the source has the name " + in_quotes(of_materials.at(material).name));
}

std::optional<VoxelClass> class_in(const JsonMembers& members, const char* key) {
  const auto number = whole_number(members, key, 0, max_class);
  return number ? std::optional(VoxelClass(*number)) : std::nullopt;
}

std::shared_ptr<const SourceClasses> source_classes_of(const JsonMembers& source) {
  if (!source.has("class") && !source.has("class_of_material") && !source.has("class_from_ids")) return nullptr;
  return with_usage_errors([&] { return std::make_shared<const SourceClasses>(classes_in(source)); });
}

std::string to_json(const SourceClasses& classes) {
  nlohmann::json out{{"class", classes.of_source}};
  for (const SourceClasses::OfMaterial& m : classes.of_materials) out["class_of_material"][m.name] = m.voxel_class;
  if (classes.ids) {
    nlohmann::json& ids = out["class_from_ids"];
    ids["add"] = classes.ids->add;
    if (!classes.ids->attribute.empty()) ids["attribute"] = classes.ids->attribute;
    if (classes.ids->feature_set) ids["feature_ids"] = *classes.ids->feature_set;
    if (classes.ids->instance_set) ids["instance_ids"] = *classes.ids->instance_set;
  }
  return out.dump();
}

SourceClasses source_classes_from_json(const std::string& text) {
  return with_usage_errors([&] {
    const std::filesystem::path file = "the classes of a source";
    const nlohmann::json json = parse_json_object(file, text);
    return classes_in(JsonMembers(file, json));
  });
}

bool takes_instance_ids(const SourceClasses* classes) {
  return classes != nullptr && classes->ids && classes->ids->instance_set;
}

bool takes_primitive_ids(const SourceClasses* classes) {
  return classes != nullptr && classes->ids && !classes->ids->instance_set;
}

VoxelClass class_of_id(double id, double null_id, const SourceClasses& classes, const std::string& where) {
  const auto refuse = [&](const std::string& message) { classes.refuse("class_from_ids", where + ": " + message); };
  if (!(id >= 0 && id < double(max_id)) || id != std::floor(id))
    refuse(fmt::format("the id {:g} is not a whole number from 0 to {}", id, max_id - 1));
  if (id == null_id) return no_class;
  const std::int64_t sum = std::int64_t(id) + classes.ids->add;
  if (sum < 0 || sum > std::int64_t(max_class))
    refuse(
        fmt::format("the id {} + {} is not a class; expected 0 to {}", std::int64_t(id), classes.ids->add, max_class));
  return VoxelClass(sum);
}

std::int32_t class_of_material(const SourceClasses* classes, std::string_view name) {
  const auto found = classes == nullptr ? std::nullopt : classes->find_material(name);
  return found ? std::int32_t(classes->of_materials[*found].voxel_class) : not_stated;
}

std::vector<std::uint32_t> classified_names(const SourceClasses* classes, const std::set<std::string>& names) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; classes != nullptr && i < classes->of_materials.size(); ++i)
    if (names.contains(classes->of_materials[i].name)) found.push_back(std::uint32_t(i));
  return found;
}

void expect_no_ids(const TileRef& tile) {
  if (tile.classes && tile.classes->ids)
    tile.classes->refuse("class_from_ids", tile.name + " has no ids; only glTF and its tiles have them");
}

void set_classes(const SceneSources& sources, BakeParameters& parameters) {
  const auto has_class = [](const auto& item) { return item.voxel_class.has_value(); };
  parameters.classes =
      std::ranges::any_of(sources.tiles, [](const TileRef& tile) { return tile.classes != nullptr; }) ||
      (sources.edits != nullptr && std::ranges::any_of(*sources.edits, has_class));
  check(parameters);
}

}  // namespace gigabake
