/// Validated access to members of JSON objects from untrusted input.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/rules.h"

namespace gigabake {

/// Parses a JSON object.
/// Errors  InputError: not a JSON object; a syntax error with its byte offset.
nlohmann::json parse_object(const std::filesystem::path& file, std::string_view text);

/// The members of one borrowed JSON object. Getters return nullopt if the member is absent.
/// Errors  All members: InputError names the file, the member and the expected value.
class JsonMembers {
 public:
  /// where: the path of the object in the file, such as "keyframes[3]"; empty for the root.
  JsonMembers(std::filesystem::path file, const nlohmann::json& object, std::string where);

  /// Throws if the object has any other member, because a misspelt one would be ignored silently.
  void only(std::initializer_list<std::string_view> known) const;
  std::optional<double> number(const char* key, double minimum, double maximum) const;
  template <std::size_t n>
  std::optional<std::array<double, n>> numbers(const char* key, double minimum, double maximum) const;
  /// Returns the enum value of that name.
  template <class Enum>
  std::optional<Enum> choice(const char* key) const;
  std::optional<bool> flag(const char* key) const;
  /// Returns the elements of an array; empty if the member is absent.
  nlohmann::json array(const char* key) const;
  [[noreturn]] void fail(const char* key, const std::string& message) const;

 private:
  const nlohmann::json* find(const char* key) const;
  double checked(const char* key, const nlohmann::json& value, double minimum, double maximum,
                 const std::string& expected) const;

  std::filesystem::path file_;
  const nlohmann::json& object_;
  std::string where_;
};

template <class Enum>
std::optional<Enum> JsonMembers::choice(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return std::nullopt;
  const std::string name = value->is_string() ? value->get<std::string>() : value->dump();
  const std::optional<Enum> chosen = value_named<Enum>(name);
  if (!chosen || !value->is_string()) fail(key, "expected one of " + all_names<Enum>() + ", got " + in_quotes(name));
  return chosen;
}

template <std::size_t n>
std::optional<std::array<double, n>> JsonMembers::numbers(const char* key, double minimum, double maximum) const {
  const nlohmann::json* value = find(key);
  if (!value) return std::nullopt;
  const std::string expected = "an array of " + std::to_string(n) + " numbers";
  if (!value->is_array() || value->size() != n) fail(key, "expected " + expected);
  std::array<double, n> out;
  for (std::size_t i = 0; i < n; ++i) out[i] = checked(key, (*value)[i], minimum, maximum, expected);
  return out;
}

}  // namespace gigabake
