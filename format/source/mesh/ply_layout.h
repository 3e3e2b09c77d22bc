/// The declarations of vertices and images in the header of a PLY.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "format/source/mesh/ply_header.h"
#include "format/source/source.h"
#include "format/source/source_files.h"
#include "format/source/source_warning.h"

namespace gigabake {

inline constexpr std::uint64_t max_ply_header_bytes = std::uint64_t(1) << 22;

/// The indices of the properties of a vertex that hold its position, colour and texture coordinates.
struct VertexLayout {
  std::array<std::optional<std::size_t>, 3> position;
  std::array<std::optional<std::size_t>, 4> colour;
  std::array<std::optional<std::size_t>, 2> uv;

  explicit VertexLayout(const PlyElement& e)
      : position{e.find({"x"}), e.find({"y"}), e.find({"z"})},
        colour{e.find({"red", "diffuse_red", "r"}), e.find({"green", "diffuse_green", "g"}),
               e.find({"blue", "diffuse_blue", "b"}), e.find({"alpha", "diffuse_alpha", "a"})},
        uv{e.find({"u", "s", "texture_u"}), e.find({"v", "t", "texture_v"})} {}

  bool has_position() const { return position[0] && position[1] && position[2]; }
  bool has_colour() const { return colour[0] && colour[1] && colour[2]; }
  bool has_uv() const { return uv[0] && uv[1]; }
};

/// Returns the path of the image that a comment TextureFile names, if the image exists and has a supported format.
std::optional<std::filesystem::path> ply_image(const TileRef& tile, const SourceFiles& files, const std::string& name);

/// Adds warnings about elements, properties and images that the header declares and the reader does not use.
void warn_of_header(const TileRef& tile, const SourceFiles& files, const PlyHeader& header, SourceWarnings& warnings);

}  // namespace gigabake
