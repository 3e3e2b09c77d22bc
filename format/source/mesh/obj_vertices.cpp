#include "format/source/mesh/obj_vertices.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/math/srgb.h"
#include "format/source/mesh/polygon.h"

namespace gigabake {
namespace {

LineName line_name(const ObjLine& line) { return {line.number}; }

/// Reads an index at `at`: 1 is the first item, -1 the last item before the face. Returns the index counted from 0,
/// `count` if no such item exists, or nullopt if the text is not a number.
std::optional<std::uint64_t> index_at(const char*& at, const char* end, std::uint64_t before, std::uint64_t count) {
  long long i = 0;
  const auto parsed = std::from_chars(at < end && *at == '+' ? at + 1 : at, end, i);
  if (parsed.ec == std::errc::invalid_argument) return std::nullopt;
  at = parsed.ptr;
  if (parsed.ec != std::errc()) return count;
  if (i < 0) i += static_cast<long long>(before) + 1;
  return i < 1 || std::uint64_t(i) > count ? count : std::uint64_t(i - 1);
}

/// Reads the index at `at`, after a slash. Sets `index`, or counts an index of a missing item in `bad`. Returns false
/// if the text is not a number.
bool take_index(const char*& at, const char* end, std::uint64_t before, std::uint64_t count, std::uint32_t& index,
                std::uint64_t& bad) {
  const auto found = index_at(at, end, before, count);
  if (!found) return false;
  if (*found == count)
    ++bad;
  else
    index = std::uint32_t(*found);
  return true;
}

/// Skips a slash. Returns whether an index follows it.
bool skip_slash(const char*& at, const char* end) {
  return at < end && *at == '/' && ++at < end && *at != '/' && *at > ' ';
}

}  // namespace

void ObjVertices::reserve(std::uint64_t positions, std::uint64_t uvs, std::uint64_t normals) {
  if (positions >= ObjCorner::none || uvs >= ObjCorner::none || normals >= ObjCorner::none)
    throw InputError(file_, "", "more than 2^32 vertices, texture coordinates or normals; split the file");
  claim_.add_items(positions, sizeof position_[0], "", "vertices");
  claim_.add_items(uvs, sizeof uv_[0], "", "texture coordinates");
  claim_.add_items(normals, sizeof normal_[0], "", "normals");
  position_.reserve(positions);
  uv_.reserve(uvs);
  normal_.reserve(normals);
}

void ObjVertices::take(const ObjLine& line, SourceWarnings& warnings) {
  if (line.word == "vn") return take_normal(line, warnings);
  const bool is_position = line.word == "v";
  expect_capacity(is_position ? position_.size() < position_.capacity() : uv_.size() < uv_.capacity(), line);
  if (is_position) return take_position(line, warnings);
  const std::vector<double> v = obj_numbers(line.rest, 2);
  if (v.empty()) warnings.count("texture coordinates without a number, taken as 0", line_name(line));
  uv_.push_back({v.empty() ? 0.0f : float(v[0]), v.size() > 1 ? float(1 - v[1]) : 1.0f});
}

void ObjVertices::expect_capacity(bool is_there, const ObjLine& line) const {
  if (!is_there) throw InputError(file_, line_name(line), "changed while it was read; bake again");
}

void ObjVertices::take_normal(const ObjLine& line, SourceWarnings& warnings) {
  std::vector<double> v = obj_numbers(line.rest, 3);
  v.resize(3);
  const VertexNormal n = encode_vertex_normal({v[0], v[1], v[2]});
  if (n[0] == no_vertex_normal) warnings.count(bad_vertex_normals, line_name(line));
  if (normal_.capacity() == 0) return;
  expect_capacity(normal_.size() < normal_.capacity(), line);
  normal_.push_back(n);
}

void ObjVertices::take_position(const ObjLine& line, SourceWarnings& warnings) {
  const std::vector<double> v = obj_numbers(line.rest, 7);
  if (v.size() < 3) {
    warnings.count_loss("vertices without three coordinates, whose faces are left out", line_name(line));
    return position_.push_back({std::nan(""), std::nan(""), std::nan("")});
  }
  position_.push_back({v[0], v[1], v[2]});
  if (v.size() < 6) return;
  if (colour_.empty()) claim_.add_items(position_.capacity(), sizeof colour_[0], "", "colours of vertices");
  colour_.reserve(position_.capacity());
  colour_.resize(position_.size());
  // The last three numbers are red, green and blue. The fourth of seven numbers is a weight.
  const std::size_t first = v.size() - 3;
  colour_.back() = {linear16(v[first]), linear16(v[first + 1]), linear16(v[first + 2]), opaque};
  if (std::any_of(v.begin() + std::ptrdiff_t(first), v.end(), [](double one) { return !(one >= 0 && one <= 1); }))
    warnings.count("vertex colours outside 0 to 1, clamped to this range", line_name(line));
}

ObjFaceFault read_obj_corners(std::string_view text, const ObjIndexRange& range, std::vector<ObjCorner>& corners,
                              ObjBadIndices& bad) {
  corners.clear();
  const char *at = text.data(), *end = at + text.size();
  while (at < end && *at != '#') {
    ObjCorner c;
    const auto position = index_at(at, end, range.positions, range.all_positions);
    if (!position) return ObjFaceFault::no_index;
    if (*position == range.all_positions) return ObjFaceFault::no_vertex;
    c.position = std::uint32_t(*position);
    if (skip_slash(at, end) && !take_index(at, end, range.uvs, range.all_uvs, c.uv, bad.uvs))
      return ObjFaceFault::no_index;
    // An index of a normal that is not a number costs only the normal.
    if (skip_slash(at, end)) take_index(at, end, range.normals, range.all_normals, c.normal, bad.normals);
    while (at<end&& * at> ' ') ++at;
    while (at < end && *at <= ' ') ++at;
    if (corners.size() == max_polygon_corners) return ObjFaceFault::too_many_corners;
    corners.push_back(c);
  }
  return ObjFaceFault::none;
}

}  // namespace gigabake
