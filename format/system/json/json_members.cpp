#include "format/system/json/json_members.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

constexpr int max_depth = 16;
constexpr std::uint64_t max_index = std::uint64_t(1) << 53;

/// A check during parsing that refuses deep nesting and repeated members. The library would keep the last of repeated
/// members.
class StructureCheck {
 public:
  explicit StructureCheck(const std::filesystem::path& file) : file_(file) {}

  bool operator()(int depth, Json::parse_event_t event, const Json& value) {
    if (depth > max_depth) throw InputError(file_, "", fmt::format("not valid JSON: nested deeper than {}", max_depth));
    if (event == Json::parse_event_t::object_start) open_.emplace_back();
    if (event == Json::parse_event_t::object_end) open_.pop_back();
    if (event == Json::parse_event_t::key) add(value.get_ref<const std::string&>());
    return true;
  }

 private:
  struct Object {
    std::set<std::string> names;
    std::string last;
  };

  void add(const std::string& name) {
    Object& object = open_.back();
    object.last = name;
    if (object.names.insert(name).second) return;
    std::string path;
    for (const Object& around : open_) path += (path.empty() ? "" : ".") + around.last;
    throw InputError(file_, path, "is there twice; keep one of them");
  }

  const std::filesystem::path& file_;
  std::vector<Object> open_;
};

}  // namespace

Json parse_json_object(const std::filesystem::path& file, std::string_view text) {
  Json out;
  StructureCheck check(file);
  const auto check_each = [&](int depth, Json::parse_event_t event, const Json& value) {
    return check(depth, event, value);
  };
  try {
    out = Json::parse(text.begin(), text.end(), check_each);
  } catch (const Json::parse_error& e) {
    throw InputError(file, "", "not valid JSON", e.byte);
  } catch (const Json::exception&) {
    throw InputError(file, "", "not valid JSON: a number that is too large");
  }
  if (!out.is_object()) throw InputError(file, "", "expected a JSON object");
  return out;
}

JsonMembers::JsonMembers(const std::filesystem::path& file, const Json& value, std::string where, JsonNull null)
    : file_(file), object_(value), where_(std::move(where)), null_(null) {
  if (!object_.is_object()) throw InputError(file_, where_, "expected a JSON object");
}

std::string JsonMembers::path_of(std::string_view key) const {
  return where_.empty() ? std::string(key) : where_ + "." + std::string(key);
}

void JsonMembers::fail(std::string_view key, const std::string& message) const {
  throw InputError(file_, path_of(key), message);
}

const Json* JsonMembers::value(std::string_view key) const {
  const auto found = object_.find(key);
  if (found == object_.end() || (null_ == JsonNull::absent && found->is_null())) return nullptr;
  return &*found;
}

const Json& JsonMembers::required(const char* key, std::string_view expected) const {
  const Json* found = value(key);
  if (found == nullptr) fail(key, expected.empty() ? "is missing" : "is missing; expected " + std::string(expected));
  return *found;
}

bool JsonMembers::contains(const char* key) const { return object_.contains(key); }

bool JsonMembers::is_null(const char* key) const {
  const auto found = object_.find(key);
  return found != object_.end() && found->is_null();
}

void JsonMembers::only(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw InputError(file_, where_,
                     fmt::format("has an unknown member {}; expected {}", in_quotes(key), fmt::join(known, ", ")));
  }
}

void JsonMembers::read(const char* key, const Json& value, bool& out) const {
  if (!value.is_boolean()) fail(key, "expected true or false");
  out = value.get<bool>();
}

void JsonMembers::read(const char* key, const Json& value, double& out) const {
  if (!value.is_number() || !std::isfinite(value.get<double>())) fail(key, "expected a finite number");
  out = value.get<double>();
}

void JsonMembers::read(const char* key, const Json& value, std::string& out) const {
  if (!value.is_string()) fail(key, "expected a text");
  out = value.get<std::string>();
}

void JsonMembers::read(const char* key, const Json& value, std::uint64_t& out) const {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max_index)
    fail(key, "expected a whole number that is not negative");
  out = value.get<std::uint64_t>();
}

void JsonMembers::read(const char* key, const Json& value, int& out) const {
  std::uint64_t number = 0;
  read(key, value, number);
  if (number > std::uint64_t(std::numeric_limits<int>::max())) fail(key, "expected a whole number below 2^31");
  out = int(number);
}

std::size_t JsonMembers::read_name(const char* key, const Json& value, std::span<const std::string_view> names) const {
  const std::string name = value.is_string() ? value.get<std::string>() : value.dump();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end() || !value.is_string())
    fail(key, fmt::format("expected one of {}, got {}", fmt::join(names, ", "), in_quotes(name)));
  return std::size_t(found - names.begin());
}

std::optional<double> JsonMembers::number(const char* key, double minimum, double maximum) const {
  const Json* found = value(key);
  if (found == nullptr) return std::nullopt;
  const double v = found->is_number() ? found->get<double>() : NAN;
  if (!(v >= minimum && v <= maximum)) fail(key, fmt::format("expected a number from {:g} to {:g}", minimum, maximum));
  return v;
}

void JsonMembers::read_numbers(const char* key, double minimum, double maximum, std::size_t count, double* out) const {
  const Json& values = required(key);
  const std::string expected = fmt::format("expected an array of {} numbers", count);
  if (!values.is_array() || values.size() != count) fail(key, expected);
  for (const Json& value : values) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(key, expected);
    *out = value.get<double>();
    if (!(*out >= minimum && *out <= maximum))
      fail(key, fmt::format("{} from {:g} to {:g}", expected, minimum, maximum));
    ++out;
  }
}

std::optional<std::vector<double>> JsonMembers::numbers(const char* key, std::size_t count) const {
  if (!has(key)) return std::nullopt;
  std::vector<double> out(count);
  read_numbers(key, -max_number, max_number, count, out.data());
  return out;
}

const Json& JsonMembers::array(const char* key) const {
  static const Json empty = Json::array();
  const Json* found = value(key);
  if (found == nullptr) return empty;
  if (!found->is_array()) fail(key, "expected an array");
  return *found;
}

const Json& JsonMembers::object(const char* key) const {
  static const Json empty = Json::object();
  const Json* found = value(key);
  if (found == nullptr) return empty;
  if (!found->is_object()) fail(key, "expected a JSON object");
  return *found;
}

JsonMembers JsonMembers::element(const char* key, const Json& array, std::size_t index) const {
  return {file_, array[index], path_of(key) + "[" + std::to_string(index) + "]", null_};
}

std::vector<JsonMembers> JsonMembers::elements(const char* key) const {
  required(key);
  const Json& values = array(key);
  std::vector<JsonMembers> out;
  for (std::size_t i = 0; i < values.size(); ++i) out.push_back(element(key, values, i));
  return out;
}

std::vector<std::string> JsonMembers::texts(const char* key) const {
  required(key);
  std::vector<std::string> out;
  for (const Json& value : array(key)) read(key, value, out.emplace_back());
  return out;
}

}  // namespace gigabake
