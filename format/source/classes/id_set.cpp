#include "format/source/classes/id_set.h"

#include <cmath>
#include <fmt/format.h>

namespace gigabake {

std::optional<double> whole_number_in(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return std::nullopt;
  const double number = object.Get(key).GetNumberAsDouble();
  return number >= 0 && number == std::floor(number) ? std::optional(number) : std::nullopt;
}

const tinygltf::Value& id_set(const tinygltf::ExtensionMap& extensions, const std::string& extension, int set,
                              const RefuseIds& refuse) {
  const auto found = extensions.find(extension);
  if (found == extensions.end()) refuse("has no " + extension);
  const tinygltf::Value& sets = found->second.Get("featureIds");
  if (!sets.IsArray() || std::size_t(set) >= sets.ArrayLen() || !sets.Get(std::size_t(set)).IsObject())
    refuse(fmt::format("{} has no set {}", extension, set));
  return sets.Get(std::size_t(set));
}

std::optional<std::string> id_attribute(const tinygltf::Value& set, const RefuseIds& refuse) {
  const auto number = whole_number_in(set, "attribute");
  if (!number && set.IsObject() && set.Has("attribute")) refuse("expected the number of an attribute of feature ids");
  return number ? std::optional(fmt::format("_FEATURE_ID_{}", std::int64_t(*number))) : std::nullopt;
}

double null_id_of(const tinygltf::Value& set) { return whole_number_in(set, "nullFeatureId").value_or(-1); }

}  // namespace gigabake
