/// The declarations of vertices and images in the header of a PLY.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/math/octahedral.h"
#include "format/source/mesh/ply_header.h"
#include "format/source/source.h"
#include "format/source/source_files.h"
#include "format/source/source_warning.h"

namespace gigabake {

inline constexpr std::uint64_t max_ply_header_bytes = std::uint64_t(1) << 22;

/// The indices of the properties of a vertex that hold its position, colour, texture coordinates and
/// normal.
struct VertexLayout {
  std::array<std::optional<std::size_t>, 3> position;
  std::array<std::optional<std::size_t>, 4> colour;
  std::array<std::optional<std::size_t>, 2> uv;
  std::array<std::optional<std::size_t>, 3> normal;

  explicit VertexLayout(const PlyElement& e)
      : position{e.find({"x"}), e.find({"y"}), e.find({"z"})},
        colour{e.find({"red", "diffuse_red", "r"}), e.find({"green", "diffuse_green", "g"}),
               e.find({"blue", "diffuse_blue", "b"}), e.find({"alpha", "diffuse_alpha", "a"})},
        uv{e.find({"u", "s", "texture_u"}), e.find({"v", "t", "texture_v"})},
        normal{e.find({"nx"}), e.find({"ny"}), e.find({"nz"})} {}

  bool has_position() const { return position[0] && position[1] && position[2]; }
  bool has_colour() const { return colour[0] && colour[1] && colour[2]; }
  bool has_uv() const { return uv[0] && uv[1]; }
  bool has_normal() const { return normal[0] && normal[1] && normal[2]; }
  /// Returns the normal of a vertex; `value` has its properties. Range: has_normal().
  VertexNormal normal_of(const std::vector<double>& value) const {
    return encode_vertex_normal({value[*normal[0]], value[*normal[1]], value[*normal[2]]});
  }
};

/// The colour of an element. Colours in the file are sRGB; integers are divided by the max value of their type.
struct PlyColour {
  using Rgba = std::array<std::uint16_t, 4>;

  /// Converts the colour of an element. `value` has one value per property of the element.
  /// Range   layout.has_colour().
  PlyColour(const PlyElement& element, const VertexLayout& layout, const std::vector<double>& value);

  Rgba rgba{0, 0, 0, 65535};  ///< linear, 65535 = 1
  bool is_clamped = false;    ///< red, green or blue was outside 0 to 1
};

/// Returns the path of the image that a comment TextureFile names, if the image exists and has a supported format.
std::optional<std::filesystem::path> ply_image(const TileRef& tile, const SourceFiles& files, const std::string& name);

/// Adds warnings about elements, properties and images that the header declares and the reader does not use.
void warn_of_header(const TileRef& tile, const SourceFiles& files, const PlyHeader& header, SourceWarnings& warnings);

}  // namespace gigabake
