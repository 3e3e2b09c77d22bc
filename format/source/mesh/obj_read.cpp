#include "format/source/mesh/obj_read.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <unordered_map>

#include "format/source/image/alpha_image.h"
#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_material.h"
#include "format/source/mesh/polygon.h"
#include "format/source/source_file.h"
#include "lattice/error.h"
#include "lattice/srgb.h"
#include "lattice/transform.h"

namespace gigabake {
namespace {

constexpr std::size_t most_corners = 65536;

using Vector = std::array<double, 3>;

/// A material of the file with what it was found in.
struct NamedMaterial {
  ObjMaterial material;
  std::filesystem::path file;
};

/// What the material files of an OBJ say, and which they are.
struct Materials {
  std::map<std::string, NamedMaterial> named;
  std::set<std::filesystem::path> files, missing;
};

Materials materials_of(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const SourceFiles& files) {
  Materials out;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
    if (line.word != "mtllib") return;
    for (const std::filesystem::path& mtl : material_files(file, line, files)) {
      out.files.insert(mtl);
      if (!files.has(mtl))
        out.missing.insert(mtl);
      else
        for (auto& [name, material] : read_mtl(mtl, files.read(mtl))) out.named[name] = {std::move(material), mtl};
    }
  });
  return out;
}

/// Corners of one material, each pair of position and texture coordinate once.
struct Part {
  Primitive primitive;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex;
  std::vector<std::uint32_t> position_of;  ///< of each vertex
  bool has_uv = true, has_colour = true;
};

class ObjReader {
 public:
  ObjReader(const TileRef& tile, const SourceFiles& files, ReadScope scope)
      : file_(tile.path), tile_(tile), files_(files), everything_(scope == ReadScope::everything) {}

  TileMesh read() {
    const std::vector<std::uint8_t> text = files_.read(file_);
    materials_ = materials_of(file_, text, files_);
    for (const std::filesystem::path& mtl : materials_.missing)
      out_.warnings.push_back("its material file " + in_quotes(name_in(files_.root(), mtl)) +
                              " is missing: what it describes is grey");
    for_each_obj_line(file_, text, [&](const ObjLine& line) { take(line); });
    finish();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const ObjLine& line, const std::string& message) const {
    throw InputError(file_, "line " + std::to_string(line.number), message);
  }

  void take(const ObjLine& line) {
    if (line.word == "v") return take_position(line);
    if (line.word == "vt") return take_uv(line);
    if (line.word == "f") return take_face(line);
    if (line.word == "usemtl" && everything_) material_ = line.rest;
    if (line.word == "p") out_.counts.skipped_points += words(line.rest);
    if (line.word == "l") out_.counts.skipped_lines += std::max<std::size_t>(words(line.rest), 1) - 1;
  }

  static std::size_t words(std::string_view text) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < text.size(); ++i) count += text[i] > ' ' && (i == 0 || text[i - 1] <= ' ') ? 1 : 0;
    return count;
  }

  void take_position(const ObjLine& line) {
    const std::vector<double> v = obj_numbers(line.rest, 7);
    if (v.size() < 3) fail(line, "expected three coordinates");
    position_.push_back({v[0], v[1], v[2]});
    if (v.size() >= 6) {
      colour_.resize(position_.size());
      // A fourth number may be a weight, and then three colours follow.
      const std::size_t first = v.size() - 3;
      colour_.back() = {v[first], v[first + 1], v[first + 2]};
    }
  }

  void take_uv(const ObjLine& line) {
    const std::vector<double> v = obj_numbers(line.rest, 2);
    if (v.empty()) fail(line, "expected texture coordinates");
    uv_.push_back({float(v[0]), v.size() > 1 ? float(1 - v[1]) : 1.0f});
  }

  struct Corner {
    std::uint32_t position = 0, uv = none;
  };
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  /// 1 is the first, -1 the last so far.
  std::uint32_t index(const ObjLine& line, const char*& at, const char* end, std::size_t count) const {
    long long i = 0;
    const auto parsed = std::from_chars(at, end, i);
    if (parsed.ec != std::errc()) fail(line, "expected corners as numbers: v, v/vt, v//vn or v/vt/vn");
    at = parsed.ptr;
    if (i < 0) i += static_cast<long long>(count) + 1;
    if (i < 1 || std::uint64_t(i) > count)
      fail(line, "a corner's index is none of the " + std::to_string(count) + " so far");
    return std::uint32_t(i - 1);
  }

  std::vector<Corner> corners_of(const ObjLine& line) const {
    std::vector<Corner> corners;
    const char *at = line.rest.data(), *end = at + line.rest.size();
    while (at < end) {
      Corner c;
      c.position = index(line, at, end, position_.size());
      if (at < end && *at == '/' && ++at < end && *at != '/' && *at > ' ') c.uv = index(line, at, end, uv_.size());
      while (at<end&& * at> ' ') ++at;  // normals are made from triangles
      while (at < end && *at <= ' ') ++at;
      corners.push_back(c);
      if (corners.size() > most_corners) fail(line, "a face of more than 65536 corners");
    }
    if (corners.size() < 3) fail(line, "a face of fewer than three corners");
    return corners;
  }

  void take_face(const ObjLine& line) {
    const std::vector<Corner> corners = corners_of(line);
    Part& part = parts_[material_];
    std::vector<Vector> polygon;
    std::vector<std::uint32_t> vertices;
    for (const Corner& c : corners) {
      polygon.push_back(position_[c.position]);
      vertices.push_back(vertex(part, c));
    }
    for (const std::uint32_t corner : triangles_of_polygon(polygon)) part.primitive.index.push_back(vertices[corner]);
  }

  std::uint32_t vertex(Part& part, const Corner& c) const {
    const std::uint32_t uv = everything_ ? c.uv : none;
    const auto [at, is_new] =
        part.vertex.try_emplace(std::uint64_t(uv) << 32 | c.position, std::uint32_t(part.position_of.size()));
    if (!is_new) return at->second;
    part.position_of.push_back(c.position);
    part.has_uv &= uv != none;
    part.has_colour &= c.position < colour_.size() && colour_[c.position].has_value();
    if (uv != none) part.primitive.uv.insert(part.primitive.uv.end(), uv_[uv].begin(), uv_[uv].end());
    return at->second;
  }

  void finish() {
    const MeshOrigin origin(tile_, position_);
    for (auto& [name, part] : parts_) {
      Primitive& p = part.primitive;
      for (const std::uint32_t v : part.position_of) origin.add_vertex(position_[v], p);
      if (!part.has_uv) p.uv.clear();
      if (everything_ && part.has_colour)
        for (const std::uint32_t v : part.position_of) {
          for (const double c : *colour_[v]) p.rgba.push_back(linear16(c));
          p.rgba.push_back(65535);
        }
      p.material = add_material(name, p.rgba.empty());
      out_.counts.triangles += p.index.size() / 3;
      out_.instances.push_back({int(out_.primitives.size()), origin.scene_from_local()});
      out_.primitives.push_back(std::move(p));
    }
    if (out_.materials.empty()) out_.materials.emplace_back();
  }

  int add_material(const std::string& name, bool is_without_colours) {
    Material material;
    const auto found = materials_.named.find(name);
    if (found == materials_.named.end()) {
      if (!materials_.missing.empty() && is_without_colours)
        std::fill_n(material.base_color.begin(), 3, grey_without_image);
    } else if (everything_) {
      const ObjMaterial& m = found->second.material;
      material.base_color = m.base_color;
      material.texture.image = add_image(found->second);
      if (m.base_color[3] < 1 || !m.alpha_map.empty()) material.alpha_mode = AlphaMode::blend;
    }
    out_.materials.push_back(material);
    return int(out_.materials.size()) - 1;
  }

  /// The index of the colour map, the alpha map in it; -1 where the material has neither.
  int add_image(const NamedMaterial& m) {
    const std::string &color = m.material.color_map, &alpha = m.material.alpha_map;
    if (color.empty() && alpha.empty()) return -1;
    const std::string key = m.file.string() + "\n" + color + "\n" + alpha;
    const auto [at, is_new] = image_.try_emplace(key, int(out_.images.size()));
    if (!is_new) return at->second;
    const auto load = [&](const std::string& name) {
      const std::filesystem::path file = map_file(m.file, name, files_);
      return EncodedImage{file.string(), files_.read(file)};
    };
    if (alpha.empty() || alpha == color)
      out_.images.push_back(load(color));
    else
      out_.images.push_back(with_alpha(color.empty() ? std::nullopt : std::optional(load(color)), load(alpha)));
    return at->second;
  }

  const std::filesystem::path& file_;
  const TileRef& tile_;
  const SourceFiles& files_;
  bool everything_;
  Materials materials_;
  std::vector<Vector> position_;
  std::vector<std::optional<Vector>> colour_;
  std::vector<std::array<float, 2>> uv_;
  std::string material_;
  std::map<std::string, Part> parts_;
  std::map<std::string, int> image_;
  TileMesh out_;
};

}  // namespace

TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope) {
  return ObjReader(tile, files, scope).read();
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
  const Materials materials = materials_of(tile.path, files.read(tile.path), files);
  std::set<std::filesystem::path> out = materials.files;
  for (const auto& [name, m] : materials.named)
    for (const std::string& map : {m.material.color_map, m.material.alpha_map})
      if (!map.empty()) out.insert(map_file(m.file, map, files));
  return {out.begin(), out.end()};
}

}  // namespace gigabake
