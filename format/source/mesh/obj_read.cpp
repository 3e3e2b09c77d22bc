#include "format/source/mesh/obj_read.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>

#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_material_table.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "lattice/srgb.h"

namespace gigabake {
namespace {

constexpr std::size_t most_corners = max_polygon_corners;
/// A vertex of a primitive with its place in Part::vertex, and a corner.
constexpr std::uint64_t vertex_bytes = 12 + 8 + 8 + 4 + 56, corner_bytes = 4;

using Vector = std::array<double, 3>;

std::size_t words(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) count += text[i] > ' ' && (i == 0 || text[i - 1] <= ' ') ? 1 : 0;
  return count;
}

/// How much there is of everything, known before any of it is kept.
struct Counts {
  std::uint64_t positions = 0, uvs = 0, triangles = 0;
};

Counts counts_of(const std::filesystem::path& file, const SourceBytes& text, ObjMaterialTable& materials) {
  Counts out;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
    if (line.word == "v") ++out.positions;
    if (line.word == "vt") ++out.uvs;
    if (line.word == "f") out.triangles += std::max<std::size_t>(words(line.rest), 2) - 2;
    if (line.word == "mtllib") materials.take(line);
  });
  return out;
}

/// Triangles of one material, each pair of position and texture coordinate once.
struct Part {
  Primitive primitive;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex;
  std::vector<std::uint32_t> position_of;  ///< of each vertex

  std::uint64_t triangles() const { return primitive.index.size() / 3; }
  std::uint64_t bytes() const { return position_of.size() * vertex_bytes + primitive.index.size() * corner_bytes; }
};

/// What all corners of a material have, whichever part they are in.
struct Common {
  bool has_uv = true, has_colour = true;
  int material = 0;  ///< in TileMesh::materials, once all corners are known
};

/// Without a sink faces are kept as they are met. With one, large files are read twice: only when all faces have been
/// looked at is it known what their materials' corners have in common.
enum class Faces { keep, look_at, hand_over };

class ObjReader {
 public:
  ObjReader(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink)
      : file_(tile.path), tile_(tile), files_(files), scope_(scope), sink_(sink), materials_(tile.path, files) {}

  TileMesh read() {
    const SourceBytes text = files_.open(file_);
    const Counts counts = counts_of(file_, text, materials_);
    out_.warnings = materials_.warnings();
    claim_.add_items(counts.positions, sizeof(Vector), "", "vertices");
    claim_.add_items(counts.uvs, sizeof(uv_[0]), "", "texture coordinates");
    position_.reserve(counts.positions);
    uv_.reserve(counts.uvs);
    is_streamed_ = sink_ && counts.triangles > part_triangles();
    read_lines(text, is_streamed_ ? Faces::look_at : Faces::keep);
    origin_.emplace(tile_, position_);
    add_materials();
    if (is_streamed_) read_lines(text, Faces::hand_over);
    for (auto& [name, part] : parts_) add_primitive(common_.at(name), part);
    if (sink_ && !is_streamed_) hand_over_parts(out_, sink_);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const ObjLine& line, const std::string& message) const {
    throw InputError(file_, "line " + std::to_string(line.number), message);
  }

  void read_lines(const SourceBytes& text, Faces faces) {
    positions_ = uvs_ = 0;
    material_.clear();
    for_each_obj_line(file_, text, [&](const ObjLine& line) {
      if (line.word == "f") return take_face(line, faces);
      if (line.word == "usemtl" && scope_ == ReadScope::everything) material_ = line.rest;
      if (line.word == "v") ++positions_;
      if (line.word == "vt") ++uvs_;
      if (faces != Faces::hand_over) return take_other(line);
      if (positions_ > position_.size() || uvs_ > uv_.size()) fail_as_changed(line);
    });
  }

  void take_other(const ObjLine& line) {
    if (line.word == "v") return take_position(line);
    if (line.word == "vt") return take_uv(line);
    if (line.word == "p") out_.counts.skipped_points += words(line.rest);
    if (line.word == "l") out_.counts.skipped_lines += std::max<std::size_t>(words(line.rest), 1) - 1;
  }

  void take_position(const ObjLine& line) {
    const std::vector<double> v = obj_numbers(line.rest, 7);
    if (v.size() < 3) fail(line, "expected three coordinates");
    if (position_.size() >= none) fail(line, "more than 2^32 vertices; split the file");
    position_.push_back({v[0], v[1], v[2]});
    if (v.size() >= 6) {
      if (colour_.empty()) claim_.add_items(position_.capacity(), sizeof(colour_[0]), "", "colours of vertices");
      colour_.reserve(position_.capacity());
      colour_.resize(position_.size());
      // A fourth number may be a weight, and then three colours follow.
      const std::size_t first = v.size() - 3;
      colour_.back() = {linear16(v[first]), linear16(v[first + 1]), linear16(v[first + 2]), opaque};
    }
  }

  void take_uv(const ObjLine& line) {
    const std::vector<double> v = obj_numbers(line.rest, 2);
    if (v.empty()) fail(line, "expected texture coordinates");
    if (uv_.size() >= none) fail(line, "more than 2^32 texture coordinates; split the file");
    uv_.push_back({float(v[0]), v.size() > 1 ? float(1 - v[1]) : 1.0f});
  }

  struct Corner {
    std::uint32_t position = 0, uv = none;
  };
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  static constexpr std::uint16_t opaque = 65535;

  /// 1 is the first, -1 the last so far.
  std::uint32_t index(const ObjLine& line, const char*& at, const char* end, std::uint64_t count) const {
    long long i = 0;
    const auto parsed = std::from_chars(at, end, i);
    if (parsed.ec != std::errc()) fail(line, "expected corners as numbers: v, v/vt, v//vn or v/vt/vn");
    at = parsed.ptr;
    if (i < 0) i += static_cast<long long>(count) + 1;
    if (i < 1 || std::uint64_t(i) > count)
      fail(line, "a corner's index is none of the " + std::to_string(count) + " so far");
    return std::uint32_t(i - 1);
  }

  void read_corners(const ObjLine& line) {
    corners_.clear();
    const char *at = line.rest.data(), *end = at + line.rest.size();
    while (at < end) {
      Corner c;
      c.position = index(line, at, end, positions_);
      if (at < end && *at == '/' && ++at < end && *at != '/' && *at > ' ') c.uv = index(line, at, end, uvs_);
      while (at<end&& * at> ' ') ++at;  // normals are made from triangles
      while (at < end && *at <= ' ') ++at;
      if (scope_ != ReadScope::everything) c.uv = none;
      corners_.push_back(c);
      if (corners_.size() > most_corners) fail(line, "a face of more than 1048576 corners");
    }
    if (corners_.size() < 3) fail(line, "a face of fewer than three corners");
  }

  void take_face(const ObjLine& line, Faces faces) {
    read_corners(line);
    if (faces == Faces::hand_over)
      make_room(line);
    else
      look_at_face();
    if (faces != Faces::look_at) add_face(parts_[material_]);
  }

  bool has_colour(const Corner& c) const { return c.position < colour_.size() && colour_[c.position][3] == opaque; }

  void look_at_face() {
    Common& common = common_[material_];
    for (const Corner& c : corners_) {
      common.has_uv &= c.uv != none;
      common.has_colour &= has_colour(c);
    }
    out_.counts.triangles += corners_.size() - 2;
  }

  void add_face(Part& part) {
    polygon_.clear();
    vertices_.clear();
    for (const Corner& c : corners_) {
      polygon_.push_back(position_[c.position]);
      vertices_.push_back(vertex(part, c));
    }
    for (const std::uint32_t corner : triangles_of_polygon(polygon_)) part.primitive.index.push_back(vertices_[corner]);
    claim_.add_items(3 * (corners_.size() - 2), corner_bytes, "", "corners of triangles");
  }

  std::uint32_t vertex(Part& part, const Corner& c) {
    const auto [at, is_new] =
        part.vertex.try_emplace(std::uint64_t(c.uv) << 32 | c.position, std::uint32_t(part.position_of.size()));
    if (!is_new) return at->second;
    claim_.add_items(1, vertex_bytes, "", "more vertices of triangles");
    part.position_of.push_back(c.position);
    if (c.uv != none) part.primitive.uv.insert(part.primitive.uv.end(), uv_[c.uv].begin(), uv_[c.uv].end());
    return at->second;
  }

  /// For the face's triangles: in the part that they belong to, and among all that are held.
  void make_room(const ObjLine& line) {
    const std::uint64_t most_held = 2 * part_triangles();
    expect_face_as_it_was(line);
    const std::uint64_t triangles = corners_.size() - 2;
    const auto own = parts_.find(material_);
    if (own != parts_.end() && own->second.triangles() + triangles > part_triangles()) hand_over(own);
    if (held_triangles_ + triangles > most_held)
      hand_over(std::max_element(parts_.begin(), parts_.end(), [](const auto& a, const auto& b) {
        return a.second.triangles() < b.second.triangles();
      }));
    held_triangles_ += triangles;
  }

  /// Between the two readings others may write the file.
  void expect_face_as_it_was(const ObjLine& line) const {
    const auto common = common_.find(material_);
    if (common == common_.end()) fail_as_changed(line);
    for (const Corner& c : corners_)
      if ((common->second.has_uv && c.uv == none) || (common->second.has_colour && !has_colour(c)))
        fail_as_changed(line);
  }

  [[noreturn]] void fail_as_changed(const ObjLine& line) const { fail(line, "is not as it was; it changed meanwhile"); }

  void hand_over(std::map<std::string, Part>::iterator part) {
    held_triangles_ -= part->second.triangles();
    add_primitive(common_.at(part->first), part->second);
    parts_.erase(part);
  }

  /// By name, as they are numbered then.
  void add_materials() {
    for (auto& [name, common] : common_) {
      common.has_colour &= scope_ == ReadScope::everything;
      common.material = materials_.add(name, common.has_colour, scope_, out_);
    }
    if (out_.materials.empty()) out_.materials.emplace_back();
  }

  void add_primitive(const Common& common, Part& part) {
    Primitive& p = part.primitive;
    for (const std::uint32_t v : part.position_of) origin_->add_vertex(position_[v], p);
    if (!common.has_uv) p.uv.clear();
    if (common.has_colour)
      for (const std::uint32_t v : part.position_of) p.rgba.insert(p.rgba.end(), colour_[v].begin(), colour_[v].end());
    p.material = common.material;
    out_.instances.push_back({int(out_.primitives.size()), origin_->scene_from_local()});
    if (!is_streamed_) return out_.primitives.push_back(std::move(p));
    const std::uint64_t bytes = part.bytes();
    out_.primitives.push_back(without_lists(p));
    sink_(out_.primitives.size() - 1, std::move(p));
    claim_.give_back(bytes);
  }

  const std::filesystem::path& file_;
  const TileRef& tile_;
  const SourceFiles& files_;
  ReadScope scope_;
  const PrimitiveSink& sink_;
  MemoryClaim claim_{file_};
  ObjMaterialTable materials_;
  std::vector<Vector> position_;
  std::vector<std::array<std::uint16_t, 4>> colour_;  ///< linear; a last one that is not `opaque`: the vertex has none
  std::vector<std::array<float, 2>> uv_;
  std::uint64_t positions_ = 0, uvs_ = 0;  ///< before the line that is read
  std::string material_;
  std::vector<Corner> corners_;  ///< of the face that is read, and the next two
  std::vector<Vector> polygon_;
  std::vector<std::uint32_t> vertices_;
  std::map<std::string, Common> common_;
  std::map<std::string, Part> parts_;
  bool is_streamed_ = false;
  std::uint64_t held_triangles_ = 0;
  std::optional<MeshOrigin> origin_;
  TileMesh out_;
};

}  // namespace

TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink) {
  return ObjReader(tile, files, scope, sink).read();
}

std::vector<Point<Local>> first_obj_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head) {
  std::vector<Point<Local>> out;
  for_each_obj_line(file, whole_lines(head), [&](const ObjLine& line) {
    if (line.word != "v" || out.size() == most_first_vertices) return;
    const std::vector<double> v = obj_numbers(line.rest, 3);
    if (v.size() == 3) out.push_back({v[0], v[1], v[2]});
  });
  return out;
}

std::vector<std::filesystem::path> obj_dependencies(const TileRef& tile, const SourceFiles& files) {
  ObjMaterialTable materials(tile.path, files);
  for_each_obj_line(tile.path, files.open(tile.path), [&](const ObjLine& line) {
    if (line.word == "mtllib") materials.take(line);
  });
  return materials.dependencies();
}

}  // namespace gigabake
