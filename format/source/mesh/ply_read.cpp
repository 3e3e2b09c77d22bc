#include "format/source/mesh/ply_read.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "core/math/transform.h"
#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/ply_layout.h"
#include "format/source/mesh/ply_parts.h"
#include "format/source/mesh/ply_values.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

using Vector = std::array<double, 3>;

constexpr std::uint64_t max_vertices = 0xffffffff;
constexpr std::uint32_t unused = ~std::uint32_t(0);
/// The keys of faces without texture coordinates in PlyReader::parts_: `of_faces` if the face has a colour, else
/// `of_vertices`.
constexpr int of_vertices = -2, of_faces = -3;

PlyHeader header_of(const std::filesystem::path& file, const SourceBytes& bytes) {
  std::vector<std::uint8_t> buffer;
  return read_ply_header(file, bytes.look(0, std::min(bytes.size(), max_ply_header_bytes), buffer));
}

class PlyReader {
 public:
  PlyReader(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink)
      : file_(tile.path),
        tile_(tile),
        files_(files),
        everything_(scope != ReadScope::positions_only),
        with_normals_(scope == ReadScope::everything),
        sink_(sink),
        bytes_(files.open(file_)),
        header_(header_of(file_, bytes_)),
        values_(file_, bytes_, header_) {}

  TileMesh read() {
    declare_vertices();
    warn_of_header(tile_, files_, header_, warnings_);
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
    if (const std::uint64_t bytes = values_.bytes_after(); bytes != 0)
      warnings_.count("bytes follow the elements that the header states, and are not read", pluralize(bytes, "byte"));
    finish();
    if (sink_ && !is_streamed_) pass_on_parts(out_, sink_);
    warn_of_alpha();
    out_.warnings = warnings_.take();
    return std::move(out_);
  }

 private:
  /// Checks the declarations in the header and claims memory for the vertices. This precedes all elements, because
  /// faces may precede the vertices that they refer to.
  void declare_vertices() {
    bool face_alpha = false;
    for (const PlyElement& e : header_.elements) {
      values_.expect_room_for(e);
      if ((e.name == "face" || e.name == "tristrips") && !has_vertices_) is_streamed_ = false;
      if (e.name == "face" && VertexLayout(e).has_colour() && VertexLayout(e).colour[3]) face_alpha = true;
      if (e.name != "vertex") continue;
      if (has_vertices_) throw InputError(file_, "element vertex", "occurs twice");
      has_vertices_ = true;
      const VertexLayout layout(e);
      if (!layout.has_position()) throw InputError(file_, "element vertex", "expected the properties x, y and z");
      if (e.count >= max_vertices) throw InputError(file_, "element vertex", "more than 2^32 vertices; split the file");
      vertices_ = e.count;
      is_float_ = e.properties[*layout.position[0]].type == PlyType::float32;
      has_colour_ = layout.has_colour();
      has_alpha_ |= has_colour_ && layout.colour[3];
      const std::uint64_t with_values = everything_ ? 8 * (layout.has_colour() + layout.has_uv()) : 0,
                          with_normal = with_normals_ && layout.has_normal() ? sizeof(VertexNormal) : 0;
      claim_.add_items(e.count, sizeof(Vector) + with_values + with_normal, "", "vertices");
      if (layout.has_colour() && everything_) rgba_.reserve(4 * e.count);
      if (layout.has_uv() && everything_) uv_.reserve(2 * e.count);
      if (with_normal != 0) normal_.reserve(e.count);
    }
    // All faces must be read to know if their alpha is 0 everywhere.
    if (face_alpha && !has_colour_) has_alpha_ = true, is_streamed_ = false;
  }

  /// Returns whether alpha applies. Some programs that do not use alpha write 0 everywhere, which is read as opaque.
  bool is_alpha_used() const { return has_alpha_ && max_alpha_ > 0; }

  void warn_of_alpha() {
    if (has_alpha_ && has_faces_ && max_alpha_ == 0)
      warnings_.count("alpha is 0 everywhere, taken as opaque", in_quotes("alpha"));
  }

  void skip(const PlyElement& element) {
    for (const PlyProperty& p : element.properties) values_.skip(p);
  }

  void read_vertices(const PlyElement& element) {
    const VertexLayout layout(element);
    const bool with_uv = everything_ && layout.has_uv();
    std::vector<double> value(element.properties.size());
    position_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < value.size(); ++p)
        if (element.properties[p].count)
          values_.skip(element.properties[p]);
        else
          value[p] = values_.number(element.properties[p].type);
      position_.push_back({value[*layout.position[0]], value[*layout.position[1]], value[*layout.position[2]]});
      origins_.add(position_.back());
      if (layout.has_colour()) {
        const PlyColour::Rgba colour = colour_of(element, layout, value);
        if (everything_) rgba_.insert(rgba_.end(), colour.begin(), colour.end());
      }
      if (layout.has_normal()) add_normal(layout, value);
      if (with_uv) uv_.insert(uv_.end(), {float(value[*layout.uv[0]]), float(1 - value[*layout.uv[1]])});
    }
  }

  void add_normal(const VertexLayout& layout, const std::vector<double>& value) {
    const VertexNormal n = layout.normal_of(value);
    if (n[0] == no_vertex_normal) warnings_.count(bad_vertex_normals, values_.place());
    if (with_normals_) normal_.push_back(n);
  }

  PlyColour::Rgba colour_of(const PlyElement& element, const VertexLayout& layout, const std::vector<double>& value) {
    const PlyColour colour(element, layout, value);
    if (colour.is_clamped) warnings_.count("colours outside 0 to 1, clamped to this range", values_.place());
    max_alpha_ = std::max(max_alpha_, colour.rgba[3]);
    return colour.rgba;
  }

  bool is_index(double v) const { return v >= 0 && v < double(vertices_) && v == std::floor(v); }

  void read_faces(const PlyElement& element) {
    const auto corners = element.find({"vertex_indices", "vertex_index"}), uv = element.find({"texcoord"}),
               texture = element.find({"texnumber"});
    if (!corners || !element.properties[*corners].count)
      throw InputError(file_, "element face", "expected the property list vertex_indices");
    has_faces_ |= element.count != 0;
    const VertexLayout layout(element);
    const bool has_colour = !has_colour_ && layout.has_colour();  // colours of vertices have precedence
    std::vector<double> value(element.properties.size());
    PlyFace face;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == corners)
          read_corners(property, face);
        else if (p == uv && property.count)
          read_uv(property, face);
        else if (property.count)
          values_.skip(property);
        else
          value[p] = values_.number(property.type);
      }
      if (texture && !element.properties[*texture].count) face.texture = texture_number(value[*texture]);
      if (has_colour) face.colour = colour_of(element, layout, value);
      add(face);
    }
  }

  void read_corners(const PlyProperty& list, PlyFace& face) {
    const std::uint64_t corners = values_.length(list);
    face.is_lost = corners > max_polygon_corners;
    if (face.is_lost) warnings_.count_loss("faces left out, since they have more than 2^20 corners", values_.place());
    face.corners.clear();
    for (std::uint64_t c = 0; c < corners; ++c) {
      const double v = values_.number(list.type);
      if (!face.is_lost && !is_index(v)) {
        face.is_lost = true;
        warnings_.count_loss("faces left out, since a corner refers to no vertex", values_.place());
      }
      if (!face.is_lost) face.corners.push_back(std::uint32_t(v));
    }
  }

  void read_uv(const PlyProperty& list, PlyFace& face) {
    face.uv.clear();
    for (std::uint64_t n = values_.length(list), i = 0; i < n; ++i) {
      const double v = values_.number(list.type);
      face.uv.push_back(float(i % 2 == 0 ? v : 1 - v));
    }
  }

  int texture_number(double v) {
    if (v >= 0 && v < double(header_.textures.size())) return int(v);
    if (!header_.textures.empty()) warnings_.count("faces whose texnumber refers to no image", values_.place());
    return -1;
  }

  /// Adds a face. Stores a polygon until all vertices are read, because its triangulation depends on the positions.
  void add(const PlyFace& face) {
    if (face.is_lost) return;
    if (face.corners.size() < 3) {
      out_.counts.skipped_points += face.corners.size() == 1 ? 1 : 0;
      out_.counts.skipped_lines += face.corners.size() == 2 ? 1 : 0;
      return;
    }
    const bool is_uv_right = face.uv.size() == 2 * face.corners.size(), has_uv = everything_ && is_uv_right;
    if (!is_uv_right && !face.uv.empty())
      warnings_.count("faces whose numbers of texture coordinates and corners differ", values_.place());
    const bool is_corner_its_own = everything_ && (has_uv || face.colour);
    const int texture = has_uv ? face.texture : face.colour && everything_ ? of_faces : of_vertices;
    PlyPart& part = parts_[texture];
    const std::uint64_t triangles = face.corners.size() - 2;
    if (is_streamed_ && !part.primitive.index.empty() && part.primitive.index.size() / 3 + triangles > part_triangles())
      finish_part(texture, part);
    claim_.add_items(3 * triangles, PlyPart::corner_bytes, "", "corners of triangles");
    std::vector<std::uint32_t> vertices;
    for (std::size_t c = 0; c < face.corners.size(); ++c)
      vertices.push_back(vertex(part, face.corners[c], is_corner_its_own));
    if (face.colour && everything_)
      for (std::size_t c = 0; c < vertices.size(); ++c)
        part.primitive.rgba.insert(part.primitive.rgba.end(), face.colour->begin(), face.colour->end());
    if (has_uv) part.primitive.uv.insert(part.primitive.uv.end(), face.uv.begin(), face.uv.end());
    if (vertices.size() == 3)
      part.primitive.index.insert(part.primitive.index.end(), vertices.begin(), vertices.end());
    else if (position_.size() == vertices_)
      add_polygon(part, vertices);
    else
      polygons_[texture].push_back(std::move(vertices));
  }

  std::uint32_t vertex(PlyPart& part, std::uint32_t position, bool is_corner_its_own) {
    if (part.vertex_of.empty() && !is_corner_its_own) {
      claim_.add_items(vertices_, sizeof unused, "", "numbers of vertices");
      part.vertex_of.assign(vertices_, unused);
    }
    if (!is_corner_its_own && part.vertex_of[position] != unused) return part.vertex_of[position];
    const auto v = std::uint32_t(part.position_of.size());
    claim_.add_items(1, PlyPart::vertex_bytes, "", "more vertices of triangles");
    part.position_of.push_back(position);
    if (!is_corner_its_own) part.vertex_of[position] = v;
    return v;
  }

  /// Reads triangle strips. A negative index begins a new strip. The corners of every second triangle are swapped, so
  /// that all triangles have the same orientation.
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
      if (!is_index(v)) {
        warnings_.count_loss("triangles of strips left out, since a corner refers to no vertex", values_.place());
        for (; n > 1; --n) values_.number(list.type);
        return;
      }
      strip.push_back(std::uint32_t(v));
      if (const std::size_t k = strip.size(); k >= 3) {
        const bool is_odd = k % 2 == 0;
        add({{strip[k - 3], strip[k - (is_odd ? 1 : 2)], strip[k - (is_odd ? 2 : 1)]}, {}, 0, {}, false});
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

  /// Moves the triangles of the part into a primitive, and passes the primitive to the sink if there is one.
  /// Range   All vertices have been read.
  void finish_part(int texture, PlyPart& part) {
    if (origins_.groups() == 0) origins_.finish();
    claim_.give_back(is_streamed_ ? part.bytes() : 0);
    Primitive p = std::move(part.primitive);
    const bool has_vertex_uv = (texture == of_vertices || texture == of_faces) && !uv_.empty();
    p.material = material_of(has_vertex_uv ? 0 : texture);
    for (const std::uint32_t v : part.position_of) {
      if (!rgba_.empty()) p.rgba.insert(p.rgba.end(), &rgba_[4 * std::size_t(v)], &rgba_[4 * std::size_t(v)] + 4);
      if (has_vertex_uv) p.uv.insert(p.uv.end(), &uv_[2 * std::size_t(v)], &uv_[2 * std::size_t(v)] + 2);
      if (!normal_.empty()) p.normal.push_back(normal_[v]);
      if (!part.vertex_of.empty()) part.vertex_of[v] = unused;
    }
    for (std::size_t a = 3; !is_alpha_used() && a < p.rgba.size(); a += 4) p.rgba[a] = 65535;
    part.primitive = {};
    out_.counts.triangles += p.index.size() / 3;
    origins_.place(std::move(p), std::exchange(part.position_of, {}), position_,
                   [&](Primitive&& piece, const MeshOrigin& at) { hand_over(std::move(piece), at); });
  }

  void hand_over(Primitive&& p, const MeshOrigin& at) {
    if (at.is_moved() && is_float_) p.position_step = at.float_step();
    out_.instances.push_back({int(out_.primitives.size()), at.scene_from_local()});
    if (!is_streamed_) return out_.primitives.push_back(std::move(p));
    out_.primitives.push_back(without_lists(p));
    sink_(out_.primitives.size() - 1, std::move(p));
  }

  /// Returns the index of the material of a texture. All parts of a texture share one material.
  int material_of(int texture) {
    const auto [at, is_new] = materials_.try_emplace(texture, 0);
    if (is_new) at->second = add_material(texture);
    return at->second;
  }

  void add_polygon(PlyPart& part, const std::vector<std::uint32_t>& polygon) const {
    std::vector<Vector> corners;
    for (const std::uint32_t v : polygon) corners.push_back(position_[part.position_of[v]]);
    for (const std::uint32_t corner : triangles_of_polygon(corners)) part.primitive.index.push_back(polygon[corner]);
  }

  /// Adds the material of a texture. If the image is missing, the vertex colours apply; without vertex colours the
  /// material is grey.
  int add_material(int texture) {
    Material material;
    if (is_alpha_used()) material.alpha_mode = AlphaMode::blend;
    if (texture >= 0 && std::size_t(texture) < header_.textures.size()) {
      if (const auto image = ply_image(tile_, files_, header_.textures[std::size_t(texture)])) {
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
  bool everything_, with_normals_;
  const PrimitiveSink& sink_;
  MemoryClaim claim_{file_};
  SourceBytes bytes_;
  PlyHeader header_;
  PlyValues values_;
  std::uint64_t vertices_ = 0;
  bool has_vertices_ = false, has_faces_ = false, is_float_ = false, has_colour_ = false, has_alpha_ = false;
  std::uint16_t max_alpha_ = 0;
  SourceWarnings warnings_;
  bool is_streamed_ = sink_ != nullptr;  ///< full parts are passed to the sink; requires that vertices precede faces
  MeshOrigins origins_{tile_};
  std::map<int, int> materials_;  ///< index in TileMesh::materials, by texture
  std::vector<Vector> position_;
  std::vector<std::uint16_t> rgba_;
  std::vector<float> uv_;
  std::vector<VertexNormal> normal_;
  std::map<int, PlyPart> parts_;
  std::map<int, std::vector<std::vector<std::uint32_t>>>
      polygons_;  ///< polygons that were read before all vertices, by texture, as vertices of the part
  TileMesh out_;
};

}  // namespace

TileMesh read_ply(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink) {
  return PlyReader(tile, files, scope, sink).read();
}

}  // namespace gigabake
