#include "format/source/mesh/stl_read.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <functional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "core/math/transform.h"
#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"
#include "format/source/source_warning.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "a binary STL is read without swapping bytes");

using StlBytes = std::span<const std::uint8_t>;
using Vector = std::array<double, 3>;
using TakeLoop = std::function<void(std::span<const Vector>)>;

constexpr std::size_t name_bytes = 80, head_bytes = 84, facet_bytes = 50, looked_at = 1024;

std::uint64_t facets_said(StlBytes bytes) {
  std::uint32_t facets = 0;
  if (bytes.size() >= head_bytes) std::memcpy(&facets, bytes.data() + name_bytes, sizeof facets);
  return facets;
}

bool begins_with_solid(StlBytes bytes) {
  constexpr std::array<std::uint8_t, 3> byte_order_mark{0xEF, 0xBB, 0xBF};
  if (bytes.size() > 3 && std::equal(byte_order_mark.begin(), byte_order_mark.end(), bytes.begin()))
    bytes = bytes.subspan(3);
  const auto first = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t c) { return c > ' '; });
  constexpr std::string_view solid = "solid";
  return std::size_t(bytes.end() - first) >= solid.size() &&
         std::equal(solid.begin(), solid.end(), first, [](char c, std::uint8_t b) { return c == std::tolower(b); });
}

/// Returns whether the STL is ASCII. `head` holds the first bytes of the file.
bool is_text(StlBytes head, std::uint64_t file_bytes) {
  if (head.size() >= head_bytes && file_bytes == head_bytes + facet_bytes * facets_said(head)) return false;
  if (!begins_with_solid(head)) return false;
  const StlBytes start = head.first(std::min(head.size(), looked_at));
  return std::find(start.begin(), start.end(), std::uint8_t(0)) == start.end();
}

/// The text "triangle 12", created only if it is needed.
struct TriangleName {
  std::uint64_t number;
  operator std::string() const { return "triangle " + std::to_string(number); }
};

/// Calls take(corners, has_attribute) for each complete facet in `bytes`. A facet has an attribute if one of its two
/// attribute bytes is not 0.
template <class Take>
void for_each_binary_facet(StlBytes bytes, const Take& take) {
  constexpr std::size_t normal_bytes = 12, attribute_at = 48;
  for (std::size_t at = 0; at + facet_bytes <= bytes.size(); at += facet_bytes) {
    std::array<float, 9> v;
    std::memcpy(v.data(), bytes.data() + at + normal_bytes, sizeof v);
    const std::array<Vector, 3> corners{{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}};
    take(corners, bytes[at + attribute_at] != 0 || bytes[at + attribute_at + 1] != 0);
  }
}

/// Returns the number of facets in a binary file. If the bytes after the header are a whole number of facets, the file
/// size determines the result. Otherwise the header determines the result, and the bytes after the facets are ignored.
/// Errors  InputError: the file is truncated.
std::uint64_t facets_in(const std::filesystem::path& file, std::uint64_t bytes, StlBytes head,
                        SourceWarnings& warnings) {
  if (bytes < head_bytes) throw InputError(file, "", "the file ends inside the header of a binary STL", bytes);
  const std::uint64_t declared = facets_said(head), there = (bytes - head_bytes) / facet_bytes;
  const bool is_whole = there > 0 && (bytes - head_bytes) % facet_bytes == 0;
  if (declared > there && !is_whole)
    throw InputError(file, "",
                     "expected " + pluralize(declared, "triangle") + " as the header states, the file holds " +
                         std::to_string(there) + "; it is cut short, or not an STL",
                     name_bytes);
  if (declared > there)
    warnings.count_loss("the header states more triangles than the file holds",
                        std::to_string(declared) + " and " + std::to_string(there));
  if (declared < there && is_whole)
    warnings.count("the header states fewer triangles than the file holds, all of which are taken",
                   std::to_string(declared) + " and " + std::to_string(there));
  if (declared <= there && !is_whole && bytes != head_bytes + declared * facet_bytes)
    warnings.count("bytes follow the triangles that the header states, and are not read",
                   pluralize(bytes - head_bytes - declared * facet_bytes, "byte"));
  return is_whole ? there : declared;
}

void read_binary(const std::filesystem::path& file, const SourceBytes& bytes, StlBytes head, const TakeLoop& take,
                 SourceWarnings& warnings) {
  constexpr std::size_t block_bytes = read_block_bytes / facet_bytes * facet_bytes;
  const std::uint64_t facets = facets_in(file, bytes.size(), head, warnings);
  const std::string_view name(reinterpret_cast<const char*>(head.data()), name_bytes);
  if (name.find("COLOR=") != name.npos) warnings.count("a colour in the header, which is not used", "COLOR=");
  std::uint64_t facet = 0;
  bytes.part(head_bytes, facet_bytes * facets).for_each_block(block_bytes, [&](StlBytes block) {
    for_each_binary_facet(block, [&](std::span<const Vector> corners, bool has_attribute) {
      if (has_attribute)
        warnings.count("triangles with attributes such as colours, which are not used", TriangleName{facet});
      ++facet;
      take(corners);
    });
  });
}

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// Returns whether a keyword of a text STL needs no action.
bool is_frame(const std::string& word) { return word == "facet" || word == "endfacet" || word == "endloop"; }

/// Calls take() for each loop of at least three corners. Returns whether the last solid has an "endsolid".
template <class Text>
bool for_each_text_loop(const std::filesystem::path& file, const Text& text, const TakeLoop& take,
                        SourceWarnings& warnings) {
  std::vector<Vector> loop;
  bool has_ended = false;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
    const std::string word = lower(line.word);
    const LineName name{line.number};
    if (word == "outer") {
      loop.clear();
    } else if (word == "solid") {
      has_ended = false;
    } else if (word == "endsolid" || (word == "end" && lower(line.rest).starts_with("solid"))) {
      has_ended = true;
    } else if (word == "vertex") {
      const std::vector<double> v = obj_numbers(line.rest, 3);
      if (v.size() != 3) warnings.count_loss("vertices without three coordinates, whose facets are left out", name);
      if (loop.size() == max_polygon_corners) throw InputError(file, name, "a facet of more than 1048576 corners");
      loop.push_back(v.size() == 3 ? Vector{v[0], v[1], v[2]} : Vector{std::nan(""), 0, 0});
    } else if (word == "color") {
      warnings.count("colours of facets, which are not used", name);
    } else if (!is_frame(word)) {
      warnings.count("lines not understood", name);
    }
    if (word != "endloop") return;
    if (loop.size() < 3)
      warnings.count_loss("facets of fewer than three corners", name);
    else
      take(loop);
    loop.clear();
  });
  return has_ended;
}

/// A reader of STL files. It reads the file twice, because the origins depend on all vertices.
class StlReader {
 public:
  StlReader(const TileRef& tile, const SourceFiles& files, const PrimitiveSink& sink)
      : tile_(tile), sink_(sink), bytes_(files.open(tile.path)) {
    const StlBytes head = bytes_.look(0, std::min<std::uint64_t>(bytes_.size(), looked_at), buffer_);
    head_.assign(head.begin(), head.end());
    is_text_ = is_text(head_, bytes_.size());
  }

  TileMesh read() {
    SourceWarnings warnings, known;
    std::uint64_t corners = 0, corners_again = 0;
    for_each_loop(
        [&](std::span<const Vector> loop) {
          for (const Vector& p : loop) origins_.add(p);
          corners += loop.size();
        },
        warnings);
    origins_.finish();
    parts_.resize(origins_.groups());
    for (std::size_t g = 0; g < parts_.size(); ++g)
      if (origins_.origin(g).is_moved() && !is_text_) parts_[g].position_step = origins_.origin(g).float_step();
    for_each_loop(
        [&](std::span<const Vector> loop) {
          corners_again += loop.size();
          if (corners_again > corners) fail_as_changed();
          add(loop);
        },
        known);
    if (corners_again != corners) fail_as_changed();
    for (std::size_t g = 0; g < parts_.size(); ++g)
      if ((g == 0 && out_.primitives.empty()) || !parts_[g].index.empty()) finish_part(g);
    out_.materials.emplace_back();
    out_.warnings = warnings.take();
    return std::move(out_);
  }

 private:
  void for_each_loop(const TakeLoop& take, SourceWarnings& warnings) const {
    if (!is_text_) return read_binary(tile_.path, bytes_, head_, take, warnings);
    if (!for_each_text_loop(tile_.path, bytes_, take, warnings))
      throw InputError(tile_.path, "", "expected \"endsolid\" at the end: the file is cut short, or not an STL",
                       bytes_.size());
  }

  [[noreturn]] void fail_as_changed() const {
    throw InputError(tile_.path, "", "changed while it was read; bake again");
  }

  /// Adds a facet to the part of the group to which its first corner belongs.
  void add(std::span<const Vector> loop) {
    const std::uint64_t triangles = loop.size() - 2;
    const std::size_t group = origins_.group_of(loop[0]);
    Primitive& part = parts_[group];
    if (sink_ && !part.index.empty() && part.index.size() / 3 + triangles > part_triangles()) finish_part(group);
    // Without a sink the whole mesh is in memory.
    if (!sink_) claim_.add_items(loop.size(), 12 + 12, "", "corners of triangles");
    const auto first = std::uint32_t(part.position.size() / 3);
    for (const Vector& p : loop) origins_.origin(group).add_vertex(p, part);
    if (loop.size() == 3) return part.index.insert(part.index.end(), {first, first + 1, first + 2}), void();
    for (const std::uint32_t corner : triangles_of_polygon(loop)) part.index.push_back(first + corner);
  }

  void finish_part(std::size_t group) {
    out_.counts.triangles += parts_[group].index.size() / 3;
    out_.instances.push_back({int(out_.primitives.size()), origins_.origin(group).scene_from_local()});
    Primitive part = std::exchange(parts_[group], without_lists(parts_[group]));
    if (!sink_) return out_.primitives.push_back(std::move(part));
    out_.primitives.push_back(without_lists(part));
    sink_(out_.primitives.size() - 1, std::move(part));
  }

  const TileRef& tile_;
  const PrimitiveSink& sink_;
  SourceBytes bytes_;
  std::vector<std::uint8_t> buffer_, head_;
  bool is_text_ = false;
  MemoryClaim claim_{tile_.path};
  MeshOrigins origins_{tile_};
  std::vector<Primitive> parts_;  ///< one part per group of origins_
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
      if (out.size() < max_first_vertices) out.push_back({p[0], p[1], p[2]});
  };
  if (!is_text(head, file_bytes)) {
    const StlBytes facets = head.subspan(std::min(head.size(), head_bytes));
    for_each_binary_facet(facets.first(std::min(facets.size(), facet_bytes * max_first_vertices)),
                          [&](std::span<const Vector> corners, bool) { take(corners); });
    return out;
  }
  SourceWarnings unused;
  for_each_text_loop(file, whole_lines(head), take, unused);
  return out;
}

}  // namespace gigabake
