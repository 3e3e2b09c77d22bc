/// The attributes of one element of a scene.xml, with errors that name the attribute.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/error.h"
#include "core/math/vec3.h"
#include "format/scene/xml/scene_reading.h"

namespace gigabake {

/// Typed access to attributes.
/// Errors  All members throw InputError with the file, the element and attribute, the expected value, and the byte
///         offset of the element.
class SceneAttributes {
 public:
  /// Stores a reference: `file` must outlive this object.
  SceneAttributes(const std::filesystem::path& file, pugi::xml_node node) : file_(file), node_(node) {}

  bool has(const char* key) const { return bool(node_.attribute(key)); }
  std::string text(const char* key) const { return std::string(view(key)); }
  template <class T>
  T value(const char* key) const {
    const std::vector<T> v = values<T>(key);
    if (v.size() != 1) fail(key, "expected one number");
    return v[0];
  }
  template <class T>
  Vec3<T> triple(const char* key) const {
    const std::vector<T> v = values<T>(key);
    if (v.size() != 3) fail(key, "expected three numbers");
    return {v[0], v[1], v[2]};
  }
  /// Returns the values of an attribute, which are separated by blanks.
  template <class T>
  std::vector<T> values(const char* key) const {
    std::vector<T> out;
    for (const std::string_view word : words(view(key))) {
      T v{};
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
      if (error != std::errc() || end != word.data() + word.size())
        fail(key, "expected numbers, got " + in_quotes(word));
      if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(v)) fail(key, "expected finite numbers, got " + in_quotes(word));
      out.push_back(v);
    }
    return out;
  }
  std::vector<Hash128> hashes(const char* key) const;
  Hash128 hash(const char* key) const;

  /// Returns faults for attributes that are not in `known` or occur twice, for elements that are not in
  /// `known_elements`, and for text between elements.
  /// Range   `known` has at most 64 names.
  std::vector<SceneFault> unknown_parts(std::span<const std::string_view> known,
                                        std::span<const std::string_view> known_elements) const;

  SceneFault fault(const std::string& key, const std::string& what) const;
  [[noreturn]] void fail(const char* key, const std::string& what) const;

 private:
  std::string_view view(const char* key) const;
  static std::vector<std::string_view> words(std::string_view text);

  const std::filesystem::path& file_;
  pugi::xml_node node_;
};

}  // namespace gigabake
