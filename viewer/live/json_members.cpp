#include "viewer/live/json_members.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gigabake {

nlohmann::json parse_object(const std::filesystem::path& file, std::string_view text) {
  nlohmann::json out;
  try {
    out = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(file, "", "not JSON", e.byte);
  } catch (const nlohmann::json::exception&) {
    throw InputError(file, "", "not JSON: holds a number that is out of range");
  }
  if (!out.is_object()) throw InputError(file, "", "expected a JSON object");
  return out;
}

JsonMembers::JsonMembers(std::filesystem::path file, const nlohmann::json& object, std::string where)
    : file_(std::move(file)), object_(object), where_(std::move(where)) {
  if (!object_.is_object()) throw InputError(file_, where_, "expected an object");
}

void JsonMembers::fail(const char* key, const std::string& message) const {
  throw InputError(file_, where_.empty() ? key : where_ + "." + key, message);
}

const nlohmann::json* JsonMembers::find(const char* key) const {
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

void JsonMembers::only(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw InputError(file_, where_, fmt::format("has an unknown member; expected {}", fmt::join(known, ", ")));
  }
}

double JsonMembers::checked(const char* key, const nlohmann::json& value, double minimum, double maximum,
                            const std::string& expected) const {
  if (!value.is_number()) fail(key, "expected " + expected);
  const double v = value.get<double>();
  if (!(v >= minimum && v <= maximum))
    fail(key, fmt::format("expected {} from {:g} to {:g}", expected, minimum, maximum));
  return v;
}

std::optional<double> JsonMembers::number(const char* key, double minimum, double maximum) const {
  const nlohmann::json* value = find(key);
  if (!value) return std::nullopt;
  return checked(key, *value, minimum, maximum, "a number");
}

std::optional<bool> JsonMembers::flag(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return std::nullopt;
  if (!value->is_boolean()) fail(key, "expected true or false");
  return value->get<bool>();
}

nlohmann::json JsonMembers::array(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return nlohmann::json::array();
  if (!value->is_array()) fail(key, "expected an array");
  return *value;
}

}  // namespace gigabake
