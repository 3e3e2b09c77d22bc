#include "format/source/mesh/ply_read.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/ply_layout.h"
#include "format/source/mesh/ply_values.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"
#include "format/source/source_file.h"
#include "lattice/counted.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "lattice/srgb.h"
#include "lattice/transform.h"

namespace gigabake {
namespace {

using Vector = std::array<double, 3>;

constexpr std::size_t most_corners = max_polygon_corners;
constexpr std::uint64_t most_vertices = 0xffffffff;
constexpr std::uint32_t unused = ~std::uint32_t(0);
/// A vertex of a primitive with its number, and a corner.
constexpr std::uint64_t vertex_bytes = 12 + 8 + 8 + 4, corner_bytes = 4;

/// The largest value of a colour's type: 1 of what is a float.
double full_of(PlyType type) {
  return is_integer(type)
             ? std::ldexp(1, int(8 * byte_count(type)) -
                                 (type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32 ? 1 : 0)) -
                   1
             : 1;
}

/// What stands in place of a texture's number where faces say nothing of textures.
constexpr int of_vertices = -2;

/// What has one texture.
struct Part {
  Primitive primitive;
  std::vector<std::uint32_t> position_of;  ///< of each vertex
  std::vector<std::uint32_t> vertex_of;    ///< of each position; unless corners have texture coordinates of their own

  std::uint64_t bytes() const { return position_of.size() * vertex_bytes + primitive.index.size() * corner_bytes; }
};

struct Face {
  std::vector<std::uint32_t> corners;
  std::vector<float> uv;  ///< of the corners, two each; or empty
  int texture = 0;
};

PlyHeader header_of(const std::filesystem::path& file, const SourceBytes& bytes) {
  std::vector<std::uint8_t> room;
  return read_ply_header(file, bytes.look(0, std::min(bytes.size(), longest_ply_header), room));
}

class PlyReader {
 public:
  PlyReader(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink)
      : file_(tile.path),
        tile_(tile),
        files_(files),
        everything_(scope == ReadScope::everything),
        sink_(sink),
        bytes_(files.open(file_)),
        header_(header_of(file_, bytes_)),
        values_(file_, bytes_, header_) {}

  TileMesh read() {
    declare_vertices();
    warn_of_missing_images();
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else if (element.name == "tristrips") {
        read_strips(element);
      } else {
        for (std::uint64_t i = 0; i < element.count; ++i) skip(element);
      }
    }
    finish();
    if (sink_ && !is_streamed_) hand_over_parts(out_, sink_);
    return std::move(out_);
  }

 private:
  /// Faces may stand before the vertices that they name.
  void declare_vertices() {
    for (const PlyElement& e : header_.elements) {
      values_.expect_room_for(e);
      if ((e.name == "face" || e.name == "tristrips") && !has_vertices_) is_streamed_ = false;
      if (e.name != "vertex") continue;
      if (has_vertices_) throw InputError(file_, "element vertex", "is there twice");
      has_vertices_ = true;
      const VertexLayout layout(e);
      if (!layout.has_position()) throw InputError(file_, "element vertex", "expected the properties x, y and z");
      if (e.count >= most_vertices)
        throw InputError(file_, "element vertex", "more than 2^32 vertices; split the file");
      vertices_ = e.count;
      is_float_ = e.properties[*layout.position[0]].type == PlyType::float32;
      has_alpha_ = layout.colour[3].has_value();
      const std::uint64_t with_values = everything_ ? 8 * (layout.has_colour() + layout.has_uv()) : 0;
      claim_.add_items(e.count, sizeof(Vector) + with_values, "", "vertices");
      if (layout.has_colour() && everything_) rgba_.reserve(4 * e.count);
      if (layout.has_uv() && everything_) uv_.reserve(2 * e.count);
    }
  }

  std::optional<std::filesystem::path> image_there(const std::string& name) const {
    const auto image = ply_image_file(tile_, files_, name);
    return image && files_.has(*image) ? image : std::nullopt;
  }

  void warn_of_missing_images() {
    for (const std::string& name : header_.textures)
      if (!image_there(name)) out_.warnings.push_back("its image " + in_quotes(name) + " is missing: taken without");
  }

  void skip(const PlyElement& element) {
    for (const PlyProperty& p : element.properties) values_.skip(p);
  }

  void read_vertices(const PlyElement& element) {
    const VertexLayout layout(element);
    const bool with_colour = everything_ && layout.has_colour(), with_uv = everything_ && layout.has_uv();
    std::vector<double> value(element.properties.size());
    position_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < value.size(); ++p)
        if (element.properties[p].count)
          values_.skip(element.properties[p]);
        else
          value[p] = values_.number(element.properties[p].type);
      position_.push_back({value[*layout.position[0]], value[*layout.position[1]], value[*layout.position[2]]});
      extent_.add(position_.back());
      if (with_colour) add_colour(element, layout, value);
      if (with_uv) uv_.insert(uv_.end(), {float(value[*layout.uv[0]]), float(1 - value[*layout.uv[1]])});
    }
  }

  void add_colour(const PlyElement& element, const VertexLayout& layout, const std::vector<double>& value) {
    const auto unit = [&](std::size_t c) {
      const std::size_t p = *layout.colour[c];
      return value[p] / full_of(element.properties[p].type);
    };
    for (std::size_t c = 0; c < 3; ++c) rgba_.push_back(linear16(unit(c)));
    const double alpha = layout.colour[3] ? unit(3) : 1;
    rgba_.push_back(std::uint16_t(std::lround((alpha >= 0 ? std::min(alpha, 1.0) : 0.0) * 65535)));
  }

  std::uint32_t index(double v) const {
    if (!(v >= 0 && v < double(vertices_)) || v != std::floor(v))
      values_.fail("a corner's index is none of the " + counted(vertices_, "vertex", "vertices"));
    return std::uint32_t(v);
  }

  void read_faces(const PlyElement& element) {
    const auto corners = element.find({"vertex_indices", "vertex_index"}), uv = element.find({"texcoord"}),
               texture = element.find({"texnumber"});
    if (!corners || !element.properties[*corners].count)
      throw InputError(file_, "element face", "expected the property list vertex_indices");
    has_faces_ |= element.count != 0;
    Face face;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == corners)
          read_corners(property, face);
        else if (everything_ && p == uv && property.count)
          read_uv(property, face);
        else if (everything_ && p == texture && !property.count)
          face.texture = texture_number(values_.number(property.type));
        else
          values_.skip(property);
      }
      add(face);
    }
  }

  void read_corners(const PlyProperty& list, Face& face) {
    const std::uint64_t corners = values_.length(list);
    if (corners > most_corners) values_.fail("a face of more than 1048576 corners");
    face.corners.clear();
    for (std::uint64_t c = 0; c < corners; ++c) face.corners.push_back(index(values_.number(list.type)));
  }

  void read_uv(const PlyProperty& list, Face& face) {
    face.uv.clear();
    for (std::uint64_t n = values_.length(list), i = 0; i < n; ++i) {
      const double v = values_.number(list.type);
      face.uv.push_back(float(i % 2 == 0 ? v : 1 - v));
    }
  }

  int texture_number(double v) const { return v >= 0 && v < double(header_.textures.size()) ? int(v) : -1; }

  /// A polygon waits until its vertices are known: its shape decides how it is cut.
  void add(const Face& face) {
    if (face.corners.size() < 3) {
      out_.counts.skipped_points += face.corners.size() == 1 ? 1 : 0;
      out_.counts.skipped_lines += face.corners.size() == 2 ? 1 : 0;
      return;
    }
    const bool has_uv = face.uv.size() == 2 * face.corners.size();
    const int texture = has_uv ? face.texture : of_vertices;
    Part& part = parts_[texture];
    const std::uint64_t triangles = face.corners.size() - 2;
    if (is_streamed_ && !part.primitive.index.empty() && part.primitive.index.size() / 3 + triangles > part_triangles())
      finish_part(texture, part);
    claim_.add_items(3 * triangles, corner_bytes, "", "corners of triangles");
    std::vector<std::uint32_t> vertices;
    for (std::size_t c = 0; c < face.corners.size(); ++c) vertices.push_back(vertex(part, face.corners[c], has_uv));
    if (has_uv) part.primitive.uv.insert(part.primitive.uv.end(), face.uv.begin(), face.uv.end());
    if (vertices.size() == 3)
      part.primitive.index.insert(part.primitive.index.end(), vertices.begin(), vertices.end());
    else if (position_.size() == vertices_)
      add_polygon(part, vertices);
    else
      polygons_[texture].push_back(std::move(vertices));
  }

  std::uint32_t vertex(Part& part, std::uint32_t position, bool is_corner_its_own) {
    if (part.vertex_of.empty() && !is_corner_its_own) {
      claim_.add_items(vertices_, sizeof unused, "", "numbers of vertices");
      part.vertex_of.assign(vertices_, unused);
    }
    if (!is_corner_its_own && part.vertex_of[position] != unused) return part.vertex_of[position];
    const auto v = std::uint32_t(part.position_of.size());
    claim_.add_items(1, vertex_bytes, "", "more vertices of triangles");
    part.position_of.push_back(position);
    if (!is_corner_its_own) part.vertex_of[position] = v;
    return v;
  }

  /// Each begins anew behind a negative index, and every other triangle turns the other way.
  void read_strips(const PlyElement& element) {
    const auto list = element.find({"vertex_indices", "vertex_index"});
    if (!list || !element.properties[*list].count)
      throw InputError(file_, "element tristrips", "expected the property list vertex_indices");
    has_faces_ |= element.count != 0;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (std::size_t p = 0; p < element.properties.size(); ++p)
        if (p == list)
          read_strip(element.properties[p]);
        else
          values_.skip(element.properties[p]);
  }

  void read_strip(const PlyProperty& list) {
    std::vector<std::uint32_t> strip;
    for (std::uint64_t n = values_.length(list); n > 0; --n) {
      const double v = values_.number(list.type);
      if (v < 0) {
        strip.clear();
        continue;
      }
      strip.push_back(index(v));
      if (const std::size_t k = strip.size(); k >= 3) {
        const bool is_odd = k % 2 == 0;
        add({{strip[k - 3], strip[k - (is_odd ? 1 : 2)], strip[k - (is_odd ? 2 : 1)]}, {}, 0});
      }
    }
  }

  void finish() {
    if (!has_faces_) out_.counts.skipped_points += vertices_;
    for (auto& [texture, part] : parts_) {
      for (const std::vector<std::uint32_t>& polygon : polygons_[texture]) add_polygon(part, polygon);
      finish_part(texture, part);
    }
    if (out_.materials.empty()) out_.materials.emplace_back();
  }

  /// Moves the part's triangles into a primitive, which a sink gets. Range  All vertices have been read.
  void finish_part(int texture, Part& part) {
    if (!origin_) origin_.emplace(tile_, extent_);
    claim_.give_back(is_streamed_ ? part.bytes() : 0);
    Primitive p = std::move(part.primitive);
    for (const std::uint32_t v : part.position_of) origin_->add_vertex(position_[v], p);
    if (origin_->is_moved() && is_float_) p.position_step = extent_.float_step();
    const bool has_vertex_uv = texture == of_vertices && !uv_.empty();
    p.material = material_of(has_vertex_uv ? 0 : texture);
    for (const std::uint32_t v : part.position_of) {
      if (!rgba_.empty()) p.rgba.insert(p.rgba.end(), &rgba_[4 * std::size_t(v)], &rgba_[4 * std::size_t(v)] + 4);
      if (has_vertex_uv) p.uv.insert(p.uv.end(), &uv_[2 * std::size_t(v)], &uv_[2 * std::size_t(v)] + 2);
      if (!part.vertex_of.empty()) part.vertex_of[v] = unused;
    }
    part.primitive = {};
    part.position_of.clear();
    out_.counts.triangles += p.index.size() / 3;
    out_.instances.push_back({int(out_.primitives.size()), origin_->scene_from_local()});
    if (!is_streamed_) return out_.primitives.push_back(std::move(p));
    out_.primitives.push_back(without_lists(p));
    sink_(out_.primitives.size() - 1, std::move(p));
  }

  /// One material per texture, however many parts show it.
  int material_of(int texture) {
    const auto [at, is_new] = materials_.try_emplace(texture, 0);
    if (is_new) at->second = add_material(texture);
    return at->second;
  }

  void add_polygon(Part& part, const std::vector<std::uint32_t>& polygon) const {
    std::vector<Vector> corners;
    for (const std::uint32_t v : polygon) corners.push_back(position_[part.position_of[v]]);
    for (const std::uint32_t corner : triangles_of_polygon(corners)) part.primitive.index.push_back(polygon[corner]);
  }

  /// Without its image a mesh has its vertices' colours, or is grey.
  int add_material(int texture) {
    Material material;
    if (has_alpha_) material.alpha_mode = AlphaMode::blend;
    if (texture >= 0 && std::size_t(texture) < header_.textures.size()) {
      if (const auto image = image_there(header_.textures[std::size_t(texture)])) {
        material.texture.image = int(out_.images.size());
        out_.images.push_back({image->string(), files_.read(*image)});
      } else if (rgba_.empty()) {
        std::fill_n(material.base_color.begin(), 3, grey_without_image);
      }
    }
    out_.materials.push_back(material);
    return int(out_.materials.size()) - 1;
  }

  const std::filesystem::path& file_;
  const TileRef& tile_;
  const SourceFiles& files_;
  bool everything_;
  const PrimitiveSink& sink_;
  MemoryClaim claim_{file_};
  SourceBytes bytes_;
  PlyHeader header_;
  PlyValues values_;
  std::uint64_t vertices_ = 0;
  bool has_vertices_ = false, has_faces_ = false, is_float_ = false, has_alpha_ = false;
  bool is_streamed_ = sink_ != nullptr;  ///< parts are handed over before the end: the vertices stand first
  PositionExtent extent_;
  std::optional<MeshOrigin> origin_;
  std::map<int, int> materials_;  ///< in TileMesh::materials, by texture
  std::vector<Vector> position_;
  std::vector<std::uint16_t> rgba_;
  std::vector<float> uv_;
  std::map<int, Part> parts_;
  std::map<int, std::vector<std::vector<std::uint32_t>>> polygons_;  ///< that stand before the vertices; a part's own
  TileMesh out_;
};

}  // namespace

TileMesh read_ply(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink) {
  return PlyReader(tile, files, scope, sink).read();
}

}  // namespace gigabake
