/// The feature table of 3D Tiles 1.0 content: values in its JSON, or in the binary part behind it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/source/source_file.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// Values of a feature table.
/// Errors  InputError(file, key): the value has another type than requested, exceeds the binary part, or is not finite.
class FeatureTable {
 public:
  /// An empty `json` is a table without values. `binary` must outlive the table.
  FeatureTable(const std::filesystem::path& file, std::span<const std::uint8_t> json,
               std::span<const std::uint8_t> binary);

  bool has(const char* key) const { return json_.contains(key); }
  std::optional<std::uint64_t> count(const char* key) const;
  std::optional<std::array<double, 3>> vector(const char* key) const;
  bool flag(const char* key) const;

  /// Returns `components` values for each of `items` features; empty if the key is absent.
  std::vector<float> floats(const char* key, std::uint64_t items, std::uint64_t components) const;
  std::vector<std::uint16_t> shorts(const char* key, std::uint64_t items, std::uint64_t components) const;
  /// Returns an id for each of `items` features; empty if the key is absent. Ids have 8, 16 or 32 bits.
  std::vector<std::uint32_t> ids(const char* key, std::uint64_t items) const;

 private:
  JsonMembers members() const { return {file_, json_, "feature table"}; }
  [[noreturn]] void fail(const char* key, const std::string& expected) const;
  const std::uint8_t* bytes_at(const char* key, std::uint64_t bytes) const;
  template <class T>
  std::vector<T> column(const char* key, std::uint64_t items, std::uint64_t components) const;

  const std::filesystem::path& file_;
  Json json_;
  std::span<const std::uint8_t> binary_;
};

}  // namespace gigabake
