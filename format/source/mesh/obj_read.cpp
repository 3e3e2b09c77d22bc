#include "format/source/mesh/obj_read.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/obj_levels.h"
#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_material_table.h"
#include "format/source/mesh/obj_vertices.h"
#include "format/source/mesh/polygon.h"
#include "format/source/mesh_parts.h"

namespace gigabake {
namespace {

/// Bytes of a vertex in a primitive and in Part::vertex, and bytes of a corner.
constexpr std::uint64_t vertex_bytes = 12 + 8 + 8 + 4 + 4 + 64, corner_bytes = 4;

using Vector = std::array<double, 3>;

std::size_t words(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) count += text[i] > ' ' && (i == 0 || text[i - 1] <= ' ') ? 1 : 0;
  return count;
}

/// Returns whether the line is a face. `fo` is the obsolete keyword for faces.
bool is_face(const ObjLine& line) { return line.word == "f" || line.word == "fo"; }

/// Numbers of elements in the file, counted before memory is reserved.
struct Counts {
  std::uint64_t positions = 0, uvs = 0, normals = 0, triangles = 0;
};

Counts counts_of(const std::filesystem::path& file, const SourceBytes& text, ObjMaterialTable& materials) {
  Counts out;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
    if (line.word == "v") ++out.positions;
    if (line.word == "vt") ++out.uvs;
    if (line.word == "vn") ++out.normals;
    if (is_face(line)) out.triangles += std::max<std::size_t>(words(line.rest), 2) - 2;
    if (line.word == "mtllib") materials.take(line);
  });
  return out;
}

/// Returns whether a keyword is irrelevant for triangle surfaces, for example groups and display settings.
bool is_without_meaning(std::string_view word) {
  static const std::set<std::string_view> words{"g",      "o",          "s",        "mg",       "mtllib",
                                                "usemap", "maplib",     "bevel",    "c_interp", "d_interp",
                                                "lod",    "shadow_obj", "trace_obj"};
  return words.count(word) != 0;
}

/// Returns whether a keyword belongs to free-form curves and surfaces.
bool is_free_form(std::string_view word) {
  static const std::set<std::string_view> words{"vp",    "cstype", "deg",  "bmat",  "step", "curv",
                                                "curv2", "surf",   "parm", "trim",  "hole", "scrv",
                                                "sp",    "end",    "con",  "ctech", "stech"};
  return words.count(word) != 0;
}

struct HashOfCorner {
  std::size_t operator()(const ObjCorner& c) const {
    const std::uint64_t mixed = (std::uint64_t(c.uv) << 32 | c.position) ^ c.normal * 0x9e3779b97f4a7c15ull;
    return std::size_t(mixed);
  }
};

/// The key of a part: its faces have one use of a material and one stated level.
struct PartKey {
  ObjMaterialUse use;
  std::int32_t lod = not_stated;

  friend auto operator<=>(const PartKey&, const PartKey&) = default;
};

/// Triangles of one material. Each triple of position, texture coordinate and normal is stored once.
struct Part {
  Primitive primitive;
  std::unordered_map<ObjCorner, std::uint32_t, HashOfCorner> vertex;
  std::vector<std::uint32_t> position_of;  ///< index of the position per vertex

  std::uint64_t triangles() const { return primitive.index.size() / 3; }
  std::uint64_t bytes() const { return position_of.size() * vertex_bytes + primitive.index.size() * corner_bytes; }
};

/// The action for each face. Small files, and files without a sink, are read once: faces are kept. Large files with a
/// sink are read twice, because materials and origins are known only after all faces have been read. The first pass
/// inspects the faces, the second pass passes them to the sink.
enum class Faces { keep, look_at, hand_over };

class ObjReader {
 public:
  ObjReader(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink)
      : tile_(tile),
        file_(tile.path),
        files_(files),
        everything_(scope != ReadScope::positions_only),
        with_normals_(scope == ReadScope::everything),
        sink_(sink),
        materials_(tile.path, files),
        vertices_(file_, claim_),
        origins_(tile),
        levels_(tile.named_sizes.get()) {}

  TileMesh read() {
    const SourceBytes text = files_.open(file_);
    const Counts counts = counts_of(file_, text, materials_);
    vertices_.reserve(counts.positions, counts.uvs, with_normals_ ? counts.normals : 0);
    normals_ = counts.normals;
    is_used_.resize(counts.positions);
    for_each_obj_line(file_, text, [&](const ObjLine& line) { take_other(line); });
    is_streamed_ = sink_ && counts.triangles > part_triangles();
    read_faces(text, is_streamed_ ? Faces::look_at : Faces::keep);
    for (std::size_t i = 0; i < is_used_.size(); ++i)
      if (is_used_[i]) origins_.add(vertices_.position()[i]);
    origins_.finish();
    add_materials();
    if (is_streamed_) read_faces(text, Faces::hand_over);
    for (auto& [key, part] : parts_) add_primitive(key, part);
    if (sink_ && !is_streamed_) pass_on_parts(out_, sink_);
    return std::move(out_);
  }

 private:
  /// Handles all lines except faces and `usemtl`.
  void take_other(const ObjLine& line) {
    if (is_face(line) || line.word == "usemtl") return;
    if (line.word == "v" || line.word == "vt" || line.word == "vn")
      vertices_.take(line, warnings_);
    else if (line.word == "p")
      out_.counts.skipped_points += words(without_comment(line.rest));
    else if (line.word == "l")
      out_.counts.skipped_lines += std::max<std::size_t>(words(without_comment(line.rest)), 1) - 1;
    else if (is_free_form(line.word))
      warnings_.count("lines of free-form curves and surfaces, which are not baked", name_of(line));
    else if (!is_without_meaning(line.word))
      warnings_.count("lines not understood", name_of(line));
  }

  static LineName name_of(const ObjLine& line) { return {line.number}; }

  void read_faces(const SourceBytes& text, Faces faces) {
    range_ = {0, 0, 0, vertices_.positions(), vertices_.uvs(), normals_};
    set_material("", faces);
    levels_.restart();
    for_each_obj_line(file_, text, [&](const ObjLine& line) {
      if (is_face(line)) return take_face(line, faces);
      levels_.take(line.word, line.rest);
      if (line.word == "usemtl") set_material(std::string(line.rest), faces);
      if (line.word == "v") ++range_.positions;
      if (line.word == "vt") ++range_.uvs;
      if (line.word == "vn") ++range_.normals;
      if (range_.positions > range_.all_positions || range_.uvs > range_.all_uvs || range_.normals > range_.all_normals)
        fail_as_changed(line);
    });
  }

  void set_material(const std::string& name, Faces faces) {
    material_ = name;
    is_new_material_ = true;
    if (faces == Faces::hand_over) return;
    const auto [known, is_new] = has_image_.try_emplace(name, false);
    if (is_new) known->second = materials_.has_image(name);
    shows_image_ = known->second;
  }

  void take_face(const ObjLine& line, Faces faces) {
    ObjBadIndices bad;
    const ObjFaceFault fault = read_obj_corners(line.rest, range_, corners_, bad);
    if (faces != Faces::hand_over) inspect_face(line, fault, bad);
    if (fault != ObjFaceFault::none || corners_.size() < 3) return;
    const ObjMaterialUse use = use_of_corners();
    for (ObjCorner& c : corners_) {
      if (!everything_ || !use.has_uv) c.uv = ObjCorner::none;
      if (!with_normals_) c.normal = ObjCorner::none;
    }
    const PartKey key{everything_ ? use : ObjMaterialUse(), levels_.lod()};
    if (faces == Faces::hand_over)
      make_room(line, key);
    else
      material_index_.try_emplace(key.use, 0);
    if (faces != Faces::look_at) add_face(parts_[key]);
  }

  ObjMaterialUse use_of_corners() const {
    ObjMaterialUse use{material_, true, true};
    for (const ObjCorner& c : corners_) {
      use.has_uv &= c.uv != ObjCorner::none;
      use.has_colour &= vertices_.has_colour(c.position);
    }
    return use;
  }

  void inspect_face(const ObjLine& line, ObjFaceFault fault, const ObjBadIndices& bad) {
    ++faces_;
    if (fault == ObjFaceFault::no_vertex) count_lost_face(line, "faces left out, since a corner refers to no vertex");
    if (fault == ObjFaceFault::no_index) count_lost_face(line, "faces left out, since a corner is not a number");
    if (fault == ObjFaceFault::too_many_corners)
      count_lost_face(line, "faces left out, since they have more than 2^20 corners");
    if (fault != ObjFaceFault::none) return;
    if (bad.uvs != 0) warnings_.count("faces that refer to missing texture coordinates", name_of(line));
    if (bad.normals != 0) warnings_.count("faces that refer to missing normals", name_of(line));
    if (corners_.size() == 1) ++out_.counts.skipped_points;
    if (corners_.size() == 2) ++out_.counts.skipped_lines;
    if (corners_.empty()) warnings_.count("lines not understood", name_of(line));
    if (corners_.size() < 3) return;
    out_.counts.triangles += corners_.size() - 2;
    for (const ObjCorner& c : corners_) is_used_[c.position] = true;
    if (std::exchange(is_new_material_, false)) used_materials_.insert(material_);
    const ObjMaterialUse use = use_of_corners();
    if (shows_image_ && !use.has_uv && bad.uvs == 0)
      warnings_.count("faces without texture coordinates, of materials with an image", name_of(line));
    if (vertices_.has_colours() && !use.has_colour)
      warnings_.count("faces without vertex colours, in a file that has some", name_of(line));
  }

  void count_lost_face(const ObjLine& line, const char* what) { warnings_.count_loss(what, name_of(line)); }

  void add_face(Part& part) {
    polygon_.clear();
    numbers_.clear();
    for (const ObjCorner& c : corners_) {
      polygon_.push_back(vertices_.position()[c.position]);
      numbers_.push_back(vertex(part, c));
    }
    for (const std::uint32_t corner : triangles_of_polygon(polygon_)) part.primitive.index.push_back(numbers_[corner]);
    claim_.add_items(3 * (corners_.size() - 2), corner_bytes, "", "corners of triangles");
  }

  std::uint32_t vertex(Part& part, const ObjCorner& c) {
    const auto [at, is_new] = part.vertex.try_emplace(c, std::uint32_t(part.position_of.size()));
    if (!is_new) return at->second;
    claim_.add_items(1, vertex_bytes, "", "more vertices of triangles");
    part.position_of.push_back(c.position);
    if (vertices_.has_normals())
      part.primitive.normal.push_back(c.normal == ObjCorner::none ? VertexNormal{no_vertex_normal, no_vertex_normal}
                                                                  : vertices_.normal(c.normal));
    if (c.uv != ObjCorner::none) {
      const auto& uv = vertices_.uv(c.uv);
      part.primitive.uv.insert(part.primitive.uv.end(), uv.begin(), uv.end());
    }
    return at->second;
  }

  /// Passes parts to the sink if the current face would exceed the max number of triangles per part or in all parts.
  void make_room(const ObjLine& line, const PartKey& key) {
    const std::uint64_t max_held = 2 * part_triangles(), triangles = corners_.size() - 2;
    if (material_index_.count(key.use) == 0) fail_as_changed(line);
    const auto own = parts_.find(key);
    if (own != parts_.end() && own->second.triangles() + triangles > part_triangles()) hand_over(own);
    if (held_triangles_ + triangles > max_held && !parts_.empty())
      hand_over(std::max_element(parts_.begin(), parts_.end(), [](const auto& a, const auto& b) {
        return a.second.triangles() < b.second.triangles();
      }));
    held_triangles_ += triangles;
  }

  /// Throws InputError: another program wrote the file between the two passes.
  [[noreturn]] void fail_as_changed(const ObjLine& line) const {
    throw InputError(file_, name_of(line), "changed while it was read; bake again");
  }

  void hand_over(std::map<PartKey, Part>::iterator part) {
    held_triangles_ -= part->second.triangles();
    add_primitive(part->first, part->second);
    parts_.erase(part);
  }

  /// Adds materials in the order of their names. This order determines their indices.
  void add_materials() {
    if (everything_)
      for (auto& [use, index] : material_index_) {
        index = materials_.add(use, with_normals_, out_);
        out_.materials[std::size_t(index)].voxel_class = class_of_material(tile_.classes.get(), use.name);
      }
    for (const auto& [use, index] : material_index_) materials_.warn_of_normal_map(use, warnings_);
    if (out_.materials.empty()) out_.materials.emplace_back();
    materials_.warn(used_materials_, warnings_);
    out_.classified = classified_names(tile_.classes.get(), used_materials_);
    out_.sized = levels_.sized(used_materials_);
    out_.warnings = warnings_.take();
    for (SourceWarning& w : out_.warnings)
      if (w.text.starts_with("faces ")) w.of = faces_;
  }

  /// Sets the coordinates of the normal map, and returns their claimed bytes. `colour` is the placement of the colour
  /// map, which is not yet applied.
  std::uint64_t set_normal_uv(const ObjMaterialUse& use, const ObjMap& colour, Primitive& p) {
    const std::optional<ObjMap> map = materials_.placed_normal_map(use);
    if (!map) return 0;
    p.shares_uv = map->scale == colour.scale && map->offset == colour.offset;
    if (p.shares_uv) return 0;
    claim_.add_items(p.uv.size(), sizeof(float), "", "texture coordinates of normal maps");
    for (std::size_t i = 0; i < p.uv.size(); i += 2) {
      const std::array<float, 2> placed = map->uv({p.uv[i], p.uv[i + 1]});
      p.normal_uv.insert(p.normal_uv.end(), placed.begin(), placed.end());
    }
    return p.uv.size() * sizeof(float);
  }

  void add_primitive(const PartKey& key, Part& part) {
    const ObjMaterialUse& use = key.use;
    Primitive& p = part.primitive;
    const ObjMap map = materials_.placed_map(use.name);
    const std::uint64_t normal_uv_bytes = with_normals_ ? set_normal_uv(use, map, p) : 0;
    for (std::size_t i = 0; !map.is_placed_as(ObjMap()) && i < p.uv.size(); i += 2) {
      const std::array<float, 2> placed = map.uv({p.uv[i], p.uv[i + 1]});
      std::copy(placed.begin(), placed.end(), p.uv.begin() + std::ptrdiff_t(i));
    }
    if (use.has_colour)
      for (const std::uint32_t v : part.position_of)
        p.rgba.insert(p.rgba.end(), vertices_.colour(v).begin(), vertices_.colour(v).end());
    p.material = material_index_.at(use);
    const std::uint64_t bytes = part.bytes() + normal_uv_bytes;
    origins_.place(std::move(p), part.position_of, vertices_.position(), [&](Primitive&& piece, const MeshOrigin& at) {
      out_.instances.push_back({int(out_.primitives.size()), at.scene_from_local(), key.lod});
      if (!is_streamed_) return out_.primitives.push_back(std::move(piece));
      out_.primitives.push_back(without_lists(piece));
      sink_(out_.primitives.size() - 1, std::move(piece));
    });
    if (is_streamed_) claim_.give_back(bytes);
  }

  const TileRef& tile_;
  const std::filesystem::path& file_;
  const SourceFiles& files_;
  bool everything_, with_normals_;
  const PrimitiveSink& sink_;
  MemoryClaim claim_{file_};
  ObjMaterialTable materials_;
  ObjVertices vertices_;
  MeshOrigins origins_;
  ObjLevels levels_;  ///< at the current line
  SourceWarnings warnings_;
  ObjIndexRange range_;  ///< at the current line
  std::uint64_t normals_ = 0;
  std::string material_;
  bool is_new_material_ = true, shows_image_ = false;
  std::map<std::string, bool> has_image_;  ///< whether a material has an image, by the material's name
  std::set<std::string> used_materials_;
  std::vector<bool> is_used_;       ///< whether a face uses the vertex, per vertex
  std::uint64_t faces_ = 0;         ///< number of face lines
  std::vector<ObjCorner> corners_;  ///< corners of the current face; polygon_ has their positions, numbers_ their
                                    ///< vertices
  std::vector<Vector> polygon_;
  std::vector<std::uint32_t> numbers_;
  std::map<ObjMaterialUse, int> material_index_;  ///< index in TileMesh::materials; set by add_materials()
  std::map<PartKey, Part> parts_;
  bool is_streamed_ = false;
  std::uint64_t held_triangles_ = 0;
  TileMesh out_;
};

}  // namespace

TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink) {
  return ObjReader(tile, files, scope, sink).read();
}

std::vector<Point<Local>> first_obj_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head) {
  std::vector<Point<Local>> out;
  for_each_obj_line(file, whole_lines(head), [&](const ObjLine& line) {
    if (line.word != "v" || out.size() == max_first_vertices) return;
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
