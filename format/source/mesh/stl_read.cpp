#include "format/source/mesh/stl_read.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <functional>
#include <utility>

#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"
#include "lattice/counted.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "lattice/transform.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "a binary STL is read as it is");

using StlBytes = std::span<const std::uint8_t>;
using Vector = std::array<double, 3>;
using TakeLoop = std::function<void(std::span<const Vector>)>;

constexpr std::size_t name_bytes = 80, head_bytes = 84, facet_bytes = 50, most_corners = max_polygon_corners,
                      looked_at = 1024;

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
  if (head.size() >= head_bytes && file_bytes == head_bytes + facet_bytes * facets_said(head)) return false;
  if (!begins_with_solid(head)) return false;
  const StlBytes start = head.first(std::min(head.size(), looked_at));
  return std::find(start.begin(), start.end(), std::uint8_t(0)) == start.end();
}

/// Visits the facets that `bytes` holds whole.
void for_each_binary_facet(StlBytes bytes, const TakeLoop& take) {
  constexpr std::size_t normal_bytes = 12;
  for (std::size_t at = 0; at + facet_bytes <= bytes.size(); at += facet_bytes) {
    std::array<float, 9> v;
    std::memcpy(v.data(), bytes.data() + at + normal_bytes, sizeof v);
    const std::array<Vector, 3> corners{{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}};
    take(corners);
  }
}

void read_binary(const std::filesystem::path& file, const SourceBytes& bytes, StlBytes head, const TakeLoop& take) {
  constexpr std::size_t block_bytes = read_block_bytes / facet_bytes * facet_bytes;
  if (bytes.size() < head_bytes)
    throw InputError(file, "", "the file ends inside the header of a binary STL", bytes.size());
  const std::uint64_t facets = facets_said(head), there = (bytes.size() - head_bytes) / facet_bytes;
  if (facets > there)
    throw InputError(file, "",
                     "expected " + counted(facets, "triangle") + " as the header says, the file holds " +
                         std::to_string(there) + "; it is cut, or no STL",
                     name_bytes);
  bytes.part(head_bytes, facet_bytes * facets).for_each_block(block_bytes, [&](StlBytes block) {
    for_each_binary_facet(block, take);
  });
}

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// Calls take() for each loop that is there whole; true where the last solid has ended.
template <class Text>
bool for_each_text_loop(const std::filesystem::path& file, const Text& text, const TakeLoop& take) {
  std::vector<Vector> loop;
  bool has_ended = false;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
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
      if (loop.size() == most_corners) fail("a facet of more than 1048576 corners");
      loop.push_back({v[0], v[1], v[2]});
    }
    if (word != "endloop") return;
    if (loop.size() < 3) fail("a facet of fewer than three corners");
    take(loop);
    loop.clear();
  });
  return has_ended;
}

/// Reads an STL twice: where its vertices are decides their origin.
class StlReader {
 public:
  StlReader(const TileRef& tile, const SourceFiles& files, const PrimitiveSink& sink)
      : tile_(tile), sink_(sink), bytes_(files.open(tile.path)) {
    const StlBytes head = bytes_.look(0, std::min<std::uint64_t>(bytes_.size(), looked_at), room_);
    head_.assign(head.begin(), head.end());
    is_text_ = is_text(head_, bytes_.size());
  }

  TileMesh read() {
    PositionExtent extent;
    std::uint64_t corners = 0, corners_again = 0;
    for_each_loop([&](std::span<const Vector> loop) {
      for (const Vector& p : loop) extent.add(p);
      corners += loop.size();
    });
    const MeshOrigin origin(tile_, extent);
    if (origin.is_moved() && !is_text_) part_.position_step = extent.float_step();
    for_each_loop([&](std::span<const Vector> loop) {
      corners_again += loop.size();
      if (corners_again > corners) fail_as_changed();
      add(loop, origin);
    });
    if (corners_again != corners) fail_as_changed();
    if (out_.primitives.empty() || !part_.index.empty()) finish_part(origin);
    out_.materials.emplace_back();
    return std::move(out_);
  }

 private:
  template <class Take>
  void for_each_loop(const Take& take) const {
    if (!is_text_) return read_binary(tile_.path, bytes_, head_, take);
    if (!for_each_text_loop(tile_.path, bytes_, take))
      throw InputError(tile_.path, "", "expected \"endsolid\" at the end: the file is cut, or no STL", bytes_.size());
  }

  [[noreturn]] void fail_as_changed() const {
    throw InputError(tile_.path, "", "changed while it was read; bake again");
  }

  void add(std::span<const Vector> loop, const MeshOrigin& origin) {
    const std::uint64_t triangles = loop.size() - 2;
    if (sink_ && !part_.index.empty() && part_.index.size() / 3 + triangles > part_triangles()) finish_part(origin);
    // Without a sink the whole mesh is held.
    if (!sink_) claim_.add_items(loop.size(), 12 + 12, "", "corners of triangles");
    const auto first = std::uint32_t(part_.position.size() / 3);
    for (const Vector& p : loop) origin.add_vertex(p, part_);
    if (loop.size() == 3) return part_.index.insert(part_.index.end(), {first, first + 1, first + 2}), void();
    for (const std::uint32_t corner : triangles_of_polygon(loop)) part_.index.push_back(first + corner);
  }

  void finish_part(const MeshOrigin& origin) {
    out_.counts.triangles += part_.index.size() / 3;
    out_.instances.push_back({int(out_.primitives.size()), origin.scene_from_local()});
    Primitive part = std::exchange(part_, without_lists(part_));
    if (!sink_) return out_.primitives.push_back(std::move(part));
    out_.primitives.push_back(without_lists(part));
    sink_(out_.primitives.size() - 1, std::move(part));
  }

  const TileRef& tile_;
  const PrimitiveSink& sink_;
  SourceBytes bytes_;
  std::vector<std::uint8_t> room_, head_;
  bool is_text_ = false;
  MemoryClaim claim_{tile_.path};
  Primitive part_;
  TileMesh out_;
};

}  // namespace

TileMesh read_stl(const TileRef& tile, const SourceFiles& files, const PrimitiveSink& sink) {
  return StlReader(tile, files, sink).read();
}

std::vector<Point<Local>> first_stl_vertices(const std::filesystem::path& file, StlBytes head,
                                             std::uint64_t file_bytes) {
  std::vector<Point<Local>> out;
  const TakeLoop take = [&](std::span<const Vector> loop) {
    for (const Vector& p : loop)
      if (out.size() < most_first_vertices) out.push_back({p[0], p[1], p[2]});
  };
  if (!is_text(head, file_bytes)) {
    const StlBytes facets = head.subspan(std::min(head.size(), head_bytes));
    for_each_binary_facet(facets.first(std::min(facets.size(), facet_bytes * most_first_vertices)), take);
    return out;
  }
  for_each_text_loop(file, whole_lines(head), take);
  return out;
}

}  // namespace gigabake
