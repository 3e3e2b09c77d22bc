/// The header of a PLY (Stanford polygon file): which elements follow, and how each value is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gigabake {

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_count(PlyType type);
bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;  ///< of a list: of its items
  std::optional<PlyType> count;     ///< of a list: of its length, an integer
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The index of the first property that has one of these names.
  std::optional<std::size_t> find(std::initializer_list<const char*> names) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< "comment TextureFile NAME", as MeshLab writes it
  std::size_t bytes = 0;              ///< where the elements begin
  std::size_t lines = 0;              ///< up to there
};

/// bytes: the file, or its beginning. Errors  InputError with the line: no PLY, not 1.0, an unknown type or keyword, a
/// count that is none, more than 1024 properties, no end.
PlyHeader read_ply_header(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace gigabake
