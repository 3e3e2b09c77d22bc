#include "format/source/tiles/feature_table.h"

#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/pluralize.h"

namespace gigabake {

FeatureTable::FeatureTable(const std::filesystem::path& file, std::span<const std::uint8_t> json,
                           std::span<const std::uint8_t> binary)
    : file_(file), json_(json.empty() ? Json::object() : parse_json(file, json)), binary_(binary) {
  if (!json_.is_object()) throw InputError(file, "feature table", "expected a JSON object");
}

void FeatureTable::fail(const char* key, const std::string& expected) const {
  members().fail(key, "expected " + expected);
}

const std::uint8_t* FeatureTable::bytes_at(const char* key, std::uint64_t bytes) const {
  const auto offset = members().members(key).find<std::uint64_t>("byteOffset");
  if (!offset || *offset > binary_.size() || binary_.size() - *offset < bytes)
    fail(key, std::to_string(bytes) + " bytes inside the table's " + std::to_string(binary_.size()));
  return binary_.data() + *offset;
}

std::optional<std::uint64_t> FeatureTable::count(const char* key) const {
  if (!has(key)) return std::nullopt;
  if (!json_[key].is_object()) return members().find<std::uint64_t>(key);
  std::uint32_t v;
  std::memcpy(&v, bytes_at(key, sizeof v), sizeof v);
  return v;
}

std::optional<std::array<double, 3>> FeatureTable::vector(const char* key) const {
  if (!has(key)) return std::nullopt;
  if (!json_[key].is_object()) {
    return members().numbers<3>(key);
  }
  const std::vector<float> v = floats(key, 1, 3);
  for (const float x : v)
    if (!std::isfinite(x)) fail(key, "3 finite numbers");
  return std::array<double, 3>{v[0], v[1], v[2]};
}

bool FeatureTable::flag(const char* key) const { return has(key) && members().get<bool>(key); }

template <class T>
std::vector<T> FeatureTable::column(const char* key, std::uint64_t items, std::uint64_t components) const {
  if (!has(key)) return {};
  if (items > binary_.size()) fail(key, pluralize(items, "item") + " inside the table");
  if (!json_[key].is_object()) fail(key, "a byteOffset into the table's binary part");
  const std::uint8_t* from = bytes_at(key, items * components * sizeof(T));
  std::vector<T> values(items * components);
  if (!values.empty()) std::memcpy(values.data(), from, values.size() * sizeof(T));
  return values;
}

std::vector<float> FeatureTable::floats(const char* key, std::uint64_t items, std::uint64_t components) const {
  return column<float>(key, items, components);
}

std::vector<std::uint32_t> FeatureTable::ids(const char* key, std::uint64_t items) const {
  const auto widened = [](const auto& column) { return std::vector<std::uint32_t>(column.begin(), column.end()); };
  const bool is_object = has(key) && json_[key].is_object();
  const auto type = is_object ? members().members(key).find<std::string>("componentType") : std::nullopt;
  if (!type || *type == "UNSIGNED_SHORT") return widened(column<std::uint16_t>(key, items, 1));
  if (*type == "UNSIGNED_BYTE") return widened(column<std::uint8_t>(key, items, 1));
  if (*type == "UNSIGNED_INT") return column<std::uint32_t>(key, items, 1);
  fail(key, "componentType UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT");
}

std::vector<std::uint16_t> FeatureTable::shorts(const char* key, std::uint64_t items, std::uint64_t components) const {
  return column<std::uint16_t>(key, items, components);
}

}  // namespace gigabake
