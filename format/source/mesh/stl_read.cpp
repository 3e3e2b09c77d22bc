#include "format/source/mesh/stl_read.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <functional>

#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_material.h"
#include "format/source/mesh/polygon.h"
#include "lattice/counted.h"
#include "lattice/error.h"
#include "lattice/transform.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "a binary STL is read as it is");

using StlBytes = std::span<const std::uint8_t>;
using Vector = std::array<double, 3>;
using TakeLoop = std::function<void(std::span<const Vector>)>;

constexpr std::size_t name_bytes = 80, head_bytes = 84, facet_bytes = 50, most_corners = 65536;

std::uint64_t facets_said(StlBytes bytes) {
  std::uint32_t facets = 0;
  if (bytes.size() >= head_bytes) std::memcpy(&facets, bytes.data() + name_bytes, sizeof facets);
  return facets;
}

bool begins_with_solid(StlBytes bytes) {
  const auto first = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t c) { return c > ' '; });
  constexpr std::string_view solid = "solid";
  return std::size_t(bytes.end() - first) >= solid.size() &&
         std::equal(solid.begin(), solid.end(), first, [](char c, std::uint8_t b) { return c == std::tolower(b); });
}

/// head: its first bytes at least.
bool is_text(StlBytes head, std::uint64_t file_bytes) {
  constexpr std::size_t looked_at = 1024;
  if (head.size() >= head_bytes && file_bytes == head_bytes + facet_bytes * facets_said(head)) return false;
  if (!begins_with_solid(head)) return false;
  const StlBytes start = head.first(std::min(head.size(), looked_at));
  return std::find(start.begin(), start.end(), std::uint8_t(0)) == start.end();
}

/// The facets that are there whole.
void for_each_binary_facet(StlBytes bytes, const TakeLoop& take) {
  constexpr std::size_t normal_bytes = 12;
  for (std::size_t at = head_bytes; at + facet_bytes <= bytes.size(); at += facet_bytes) {
    std::array<float, 9> v;
    std::memcpy(v.data(), bytes.data() + at + normal_bytes, sizeof v);
    const std::array<Vector, 3> corners{{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}};
    take(corners);
  }
}

void read_binary(const std::filesystem::path& file, StlBytes bytes, const TakeLoop& take) {
  if (bytes.size() < head_bytes)
    throw InputError(file, "", "the file ends inside the header of a binary STL", bytes.size());
  const std::uint64_t facets = facets_said(bytes), there = (bytes.size() - head_bytes) / facet_bytes;
  if (facets > there)
    throw InputError(file, "",
                     "expected " + counted(facets, "triangle") + " as the header says, the file holds " +
                         std::to_string(there) + "; it is cut, or no STL",
                     name_bytes);
  for_each_binary_facet(bytes.first(head_bytes + facet_bytes * facets), take);
}

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// Calls take() for each loop that is there whole; true where the last solid has ended.
bool for_each_text_loop(const std::filesystem::path& file, StlBytes bytes, const TakeLoop& take) {
  std::vector<Vector> loop;
  bool has_ended = false;
  for_each_obj_line(file, bytes, [&](const ObjLine& line) {
    const auto fail = [&](const char* message) {
      throw InputError(file, "line " + std::to_string(line.number), message);
    };
    const std::string word = lower(line.word);
    if (word == "outer") loop.clear();
    if (word == "solid") has_ended = false;
    if (word == "endsolid") has_ended = true;
    if (word == "vertex") {
      const std::vector<double> v = obj_numbers(line.rest, 3);
      if (v.size() != 3) fail("expected three coordinates");
      if (loop.size() == most_corners) fail("a facet of more than 65536 corners");
      loop.push_back({v[0], v[1], v[2]});
    }
    if (word != "endloop") return;
    if (loop.size() < 3) fail("a facet of fewer than three corners");
    take(loop);
    loop.clear();
  });
  return has_ended;
}

void for_each_loop(const std::filesystem::path& file, StlBytes bytes, const TakeLoop& take) {
  if (!is_text(bytes, bytes.size())) return read_binary(file, bytes, take);
  if (!for_each_text_loop(file, bytes, take))
    throw InputError(file, "", "expected \"endsolid\" at the end: the file is cut, or no STL", bytes.size());
}

}  // namespace

TileMesh read_stl(const TileRef& tile, const SourceFiles& files) {
  const std::vector<std::uint8_t> bytes = files.read(tile.path);
  std::vector<Vector> position;
  Primitive out;
  for_each_loop(tile.path, bytes, [&](std::span<const Vector> loop) {
    const auto first = std::uint32_t(position.size());  // a file of 4 GiB has no more
    position.insert(position.end(), loop.begin(), loop.end());
    if (loop.size() == 3) return out.index.insert(out.index.end(), {first, first + 1, first + 2}), void();
    for (const std::uint32_t corner : triangles_of_polygon(loop)) out.index.push_back(first + corner);
  });
  const MeshOrigin origin(tile, position);
  for (const Vector& p : position) origin.add_vertex(p, out);
  if (origin.is_moved() && !is_text(bytes, bytes.size())) out.position_step = float_step_of(position);
  TileMesh mesh;
  mesh.counts.triangles = out.index.size() / 3;
  mesh.instances.push_back({0, origin.scene_from_local()});
  mesh.primitives.push_back(std::move(out));
  mesh.materials.emplace_back();
  return mesh;
}

std::vector<Point<Local>> first_stl_vertices(const std::filesystem::path& file, StlBytes head,
                                             std::uint64_t file_bytes) {
  std::vector<Point<Local>> out;
  const TakeLoop take = [&](std::span<const Vector> loop) {
    for (const Vector& p : loop)
      if (out.size() < most_first_vertices) out.push_back({p[0], p[1], p[2]});
  };
  if (!is_text(head, file_bytes)) {
    for_each_binary_facet(head.first(std::min(head.size(), head_bytes + facet_bytes * most_first_vertices)), take);
    return out;
  }
  for_each_text_loop(file, whole_lines(head), take);
  return out;
}

}  // namespace gigabake
