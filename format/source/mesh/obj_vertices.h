/// The vertices and texture coordinates of an OBJ, and the corners of its faces, which name them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/source/mesh/obj_lines.h"
#include "format/source/source_warning.h"
#include "lattice/memory_limit.h"

namespace gigabake {

class ObjVertices {
 public:
  /// claim: for what is allocated; it outlives this.
  explicit ObjVertices(const std::filesystem::path& file, MemoryClaim& claim) : file_(file), claim_(claim) {}

  /// Errors  InputError: more than 2^32 - 1 of either, or more memory than allowed.
  void reserve(std::uint64_t positions, std::uint64_t uvs);
  /// Takes in a line `v` or `vt`. One without its numbers keeps its place: a vertex becomes NaN.
  void take(const ObjLine& line, SourceWarnings& warnings);

  std::size_t positions() const { return position_.size(); }
  std::size_t uvs() const { return uv_.size(); }
  const std::vector<std::array<double, 3>>& position() const { return position_; }
  const std::array<float, 2>& uv(std::uint32_t i) const { return uv_[i]; }
  /// Has the vertex a colour?
  bool has_colour(std::uint32_t i) const { return i < colour_.size() && colour_[i][3] == opaque; }
  bool has_colours() const { return !colour_.empty(); }
  /// Returns its colour: linear, 65535 = 1.
  const std::array<std::uint16_t, 4>& colour(std::uint32_t i) const { return colour_[i]; }

 private:
  static constexpr std::uint16_t opaque = 65535;

  void take_position(const ObjLine& line, SourceWarnings& warnings);

  const std::filesystem::path& file_;
  MemoryClaim& claim_;
  std::vector<std::array<double, 3>> position_;
  std::vector<std::array<std::uint16_t, 4>> colour_;  ///< one that is not `opaque`: the vertex has none
  std::vector<std::array<float, 2>> uv_;
};

struct ObjCorner {
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  std::uint32_t position = 0, uv = none;
};

/// How many vertices and texture coordinates stand before a face, which negative indices count back from, and how many
/// the file has.
struct ObjIndexRange {
  std::uint64_t positions = 0, uvs = 0, all_positions = 0, all_uvs = 0;
};

enum class ObjFaceFault : std::uint8_t { none, no_index, no_vertex, too_many_corners };

/// Reads the corners of a line `f`, up to a comment. An index of texture coordinates that are not there is counted in
/// `bad_uvs`, and the corner has none.
ObjFaceFault read_obj_corners(std::string_view text, const ObjIndexRange& range, std::vector<ObjCorner>& corners,
                              std::uint64_t& bad_uvs);

}  // namespace gigabake
