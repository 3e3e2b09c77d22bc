/// What a user or a source may choose of a few possibilities. Each name is written once, beside its enum: parsers,
/// files, messages and help all take it from names_of(). A name or number that is none of an enum's values is an error
/// of whoever read it, never another value.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gigabake {

/// Which voxels a triangle's surface fills, and with how much coverage (docs/accuracy.md).
enum class SurfaceRule : std::uint8_t { area, conservative, thin };
/// How a coarser voxel is made of finer ones (docs/accuracy.md).
enum class MipFilter : std::uint8_t { coverage, thesis, box };
/// What a material's alpha means. Source  glTF 2.0, 3.9.4.
enum class AlphaMode : std::uint8_t { opaque, mask, blend };
/// How texture coordinates beyond the image are taken. Source  glTF 2.0, sampler.wrapS.
enum class Wrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };
/// How a shard's chunks are compressed. Both give back the same bytes.
enum class Codec : std::uint8_t {
  lz4,      ///< HDF5 filter 32004: three times as fast either way
  deflate,  ///< HDF5's own filter 1, which every HDF5 has: a quarter smaller
};

/// The name of each value, in the values' order: what is not listed is not a value.
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
constexpr auto names_of<AlphaMode>() {  // as glTF writes them
  return std::to_array<std::string_view>({"OPAQUE", "MASK", "BLEND"});
}
template <>
constexpr auto names_of<Codec>() {
  return std::to_array<std::string_view>({"lz4", "deflate"});
}

/// The value's name; "unknown" for a number that is none of its values.
template <class Enum>
constexpr std::string_view name_of(Enum value) {
  constexpr auto names = names_of<Enum>();
  return std::size_t(value) < names.size() ? names[std::size_t(value)] : std::string_view("unknown");
}

/// Nothing where no value has this name: the caller says where the name stands.
template <class Enum>
constexpr std::optional<Enum> value_named(std::string_view name) {
  constexpr auto names = names_of<Enum>();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return Enum(i);
  return std::nullopt;
}

/// Each value, in order.
template <class Enum>
constexpr auto values_of() {
  std::array<Enum, names_of<Enum>().size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = Enum(i);
  return values;
}

/// "area, conservative, thin", for messages and help.
template <class Enum>
std::string all_names(std::string_view separator = ", ") {
  std::string all;
  for (const std::string_view name : names_of<Enum>()) {
    if (!all.empty()) all += separator;
    all += name;
  }
  return all;
}

/// Nothing for a number that is none of its values.
template <class Enum>
constexpr std::optional<Enum> value_numbered(std::uint64_t number) {
  if (number >= names_of<Enum>().size()) return std::nullopt;
  return Enum(number);
}

}  // namespace gigabake
