/// The enumerations of options. Each name is defined once, next to its enum: parsers, files, messages and help use
/// names_of(). An unknown name or number is an error and is never mapped to another value.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gigabake {

/// The rule that selects the voxels of a triangle and their coverage (docs/accuracy.md).
enum class SurfaceRule : std::uint8_t { area, conservative, thin };
/// The filter that computes coarser voxels from finer voxels (docs/accuracy.md).
enum class MipFilter : std::uint8_t { coverage, thesis, box };
/// The meaning of a material's alpha.
/// Source  glTF 2.0, 3.9.4.
enum class AlphaMode : std::uint8_t { opaque, mask, blend };
/// The treatment of texture coordinates outside the image.
/// Source  glTF 2.0, sampler.wrapS.
enum class Wrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };
/// The compression of a shard's chunks. Both codecs are lossless.
enum class Codec : std::uint8_t {
  lz4,      ///< HDF5 filter 32004: compresses and decompresses three times as fast as deflate
  deflate,  ///< HDF5's built-in filter 1, always available: a quarter smaller than lz4
};

/// Returns the name of each value in the order of the values. A value without a name in the array is invalid.
template <class Enum>
constexpr auto names_of();
template <>
constexpr auto names_of<SurfaceRule>() {
  return std::to_array<std::string_view>({"area", "conservative", "thin"});
}
template <>
constexpr auto names_of<MipFilter>() {
  return std::to_array<std::string_view>({"coverage", "thesis", "box"});
}
template <>
constexpr auto names_of<AlphaMode>() {  // as in glTF
  return std::to_array<std::string_view>({"OPAQUE", "MASK", "BLEND"});
}
template <>
constexpr auto names_of<Codec>() {
  return std::to_array<std::string_view>({"lz4", "deflate"});
}

/// Returns the value's name, or "unknown" if the number is none of the enum's values.
template <class Enum>
constexpr std::string_view name_of(Enum value) {
  constexpr auto names = names_of<Enum>();
  return std::size_t(value) < names.size() ? names[std::size_t(value)] : std::string_view("unknown");
}

/// Returns the value with this name, or nullopt. The caller reports the place of an unknown name.
template <class Enum>
constexpr std::optional<Enum> value_named(std::string_view name) {
  constexpr auto names = names_of<Enum>();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return Enum(i);
  return std::nullopt;
}

/// Returns all values in order.
template <class Enum>
constexpr auto values_of() {
  std::array<Enum, names_of<Enum>().size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = Enum(i);
  return values;
}

/// Returns all names in one string, "area, conservative, thin", for messages and help.
template <class Enum>
std::string all_names(std::string_view separator = ", ") {
  std::string all;
  for (const std::string_view name : names_of<Enum>()) {
    if (!all.empty()) all += separator;
    all += name;
  }
  return all;
}

/// Returns the value with this number, or nullopt.
template <class Enum>
constexpr std::optional<Enum> value_numbered(std::uint64_t number) {
  if (number >= names_of<Enum>().size()) return std::nullopt;
  return Enum(number);
}

}  // namespace gigabake
