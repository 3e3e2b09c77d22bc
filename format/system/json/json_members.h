/// Typed access to the members of JSON objects from untrusted files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/rules.h"

namespace gigabake {

/// Parses a text with one JSON object, for file formats of this program. Such files have few levels and need no memory
/// limit.
/// Errors  InputError if the text is not a JSON object, has a syntax error (with its byte offset), or nests deeper than
///         16. InputError if a number is out of range, or if an object has a member twice.
nlohmann::json parse_json_object(const std::filesystem::path& file, std::string_view text);

/// The treatment of a member whose value is null: as an absent member, or as a value of a wrong type.
enum class JsonNull : std::uint8_t { absent, refused };

/// The members of one JSON object. Stores references to the file's name and the object.
/// Errors  All functions throw InputError with the file, the path of the member and the expected value.
class JsonMembers {
 public:
  /// `where` is the path of the object in the file, such as "keyframes[3]"; empty for the root.
  JsonMembers(const std::filesystem::path& file, const nlohmann::json& value, std::string where = {},
              JsonNull null = JsonNull::absent);

  const std::filesystem::path& file() const { return file_; }
  /// Returns the path of the object in the file.
  const std::string& path() const { return where_; }
  /// Returns false if find() would return nullopt, true if it would return a value or throw.
  bool has(const char* key) const { return value(key) != nullptr; }
  /// Returns the value of a member, of any type; null if the member is absent.
  const nlohmann::json* value(std::string_view key) const;
  bool contains(const char* key) const;  ///< true also for a member that is null
  bool is_null(const char* key) const;
  /// Throws if the object has a member that is not in `known`, because a misspelt member would be ignored silently.
  void only(std::initializer_list<std::string_view> known) const;

  /// Returns a member; nullopt if it is absent. T is bool, double (finite), std::string, std::uint64_t, int (not
  /// negative), or an enum with names_of(). A std::uint64_t has no fraction and no exponent and is at most 2^53, so
  /// that all parsers read the same value.
  template <class T>
  std::optional<T> find(const char* key) const;
  /// Returns a member of a type that find() supports.
  /// Errors  The errors of find(), and InputError if the member is absent. `expected` describes the value in the
  ///         message, such as "seconds".
  template <class T>
  T get(const char* key, std::string_view expected = {}) const;

  /// Returns a member that is a number in [minimum, maximum]; nullopt if the member is absent.
  std::optional<double> number(const char* key, double minimum, double maximum) const;
  /// Returns a member that is an array of exactly n finite numbers in [minimum, maximum]; nullopt if the member is
  /// absent.
  template <std::size_t n>
  std::optional<std::array<double, n>> numbers(const char* key, double minimum = -max_number,
                                               double maximum = max_number) const;

  std::optional<std::vector<double>> numbers(const char* key, std::size_t count) const;  ///< finite numbers

  /// Returns a member that is an array or an object. If the member is absent, returns an empty array or object.
  const nlohmann::json& array(const char* key) const;
  const nlohmann::json& object(const char* key) const;
  /// Returns the members of an object; no members if the object is absent.
  JsonMembers members(const char* key) const { return {file_, object(key), path_of(key), null_}; }
  /// Returns the members of an array's element.
  JsonMembers element(const char* key, const nlohmann::json& array, std::size_t index) const;
  /// Returns the results of `read` for the elements of a required array of objects.
  template <class Read>
  auto list(const char* key, const Read& read) const;
  std::vector<JsonMembers> elements(const char* key) const;  ///< objects of a required array
  std::vector<std::string> texts(const char* key) const;     ///< elements of a required array

  /// Returns the path of a member in the file, such as "keyframes[3].eye".
  std::string path_of(std::string_view key) const;
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;

 private:
  static constexpr double max_number = std::numeric_limits<double>::max();

  const nlohmann::json& required(const char* key, std::string_view expected = {}) const;
  /// Converts a value that is present.
  void read(const char* key, const nlohmann::json& value, bool& out) const;
  void read(const char* key, const nlohmann::json& value, double& out) const;
  void read(const char* key, const nlohmann::json& value, std::string& out) const;
  void read(const char* key, const nlohmann::json& value, std::uint64_t& out) const;
  void read(const char* key, const nlohmann::json& value, int& out) const;
  template <class Enum>
  requires std::is_enum_v<Enum>
  void read(const char* key, const nlohmann::json& value, Enum& out) const;
  /// Returns the index in `names` of the value, which must be one of these texts.
  std::size_t read_name(const char* key, const nlohmann::json& value, std::span<const std::string_view> names) const;
  void read_numbers(const char* key, double minimum, double maximum, std::size_t count, double* out) const;

  const std::filesystem::path& file_;
  const nlohmann::json& object_;
  std::string where_;
  JsonNull null_;
};

template <class T>
std::optional<T> JsonMembers::find(const char* key) const {
  const nlohmann::json* found = value(key);
  if (found == nullptr) return std::nullopt;
  T out;
  read(key, *found, out);
  return out;
}

template <class T>
T JsonMembers::get(const char* key, std::string_view expected) const {
  T out;
  read(key, required(key, expected), out);
  return out;
}

template <class Enum>
requires std::is_enum_v<Enum>
void JsonMembers::read(const char* key, const nlohmann::json& value, Enum& out) const {
  constexpr auto names = names_of<Enum>();
  out = Enum(read_name(key, value, names));
}

template <std::size_t n>
std::optional<std::array<double, n>> JsonMembers::numbers(const char* key, double minimum, double maximum) const {
  if (!has(key)) return std::nullopt;
  std::array<double, n> out;
  read_numbers(key, minimum, maximum, n, out.data());
  return out;
}

template <class Read>
auto JsonMembers::list(const char* key, const Read& read) const {
  std::vector<decltype(read(*this))> out;
  for (const JsonMembers& element : elements(key)) out.push_back(read(element));
  return out;
}

}  // namespace gigabake
