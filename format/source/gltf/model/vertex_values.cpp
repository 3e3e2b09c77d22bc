#include "format/source/gltf/model/vertex_values.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "format/source/mesh_parts.h"

namespace gigabake {
namespace {

/// Bytes of a vertex: its position, its texture coordinates, and its colour before and after conversion. Bytes of a
/// normal and of a tangent before and after conversion, of further coordinates, and of an id and its class.
constexpr std::uint64_t vertex_bytes = 12 + 8 + 16 + 8, normal_bytes = 12 + 4, tangent_bytes = 16 + 4, uv_bytes = 8,
                        id_bytes = 4 + 2;

std::uint16_t unit16(float v) { return v > 0 ? std::uint16_t(std::min(v, 1.0f) * 65535.0f + 0.5f) : std::uint16_t(0); }

std::vector<std::uint16_t> linear_colours(const std::vector<float>& rgba) {
  std::vector<std::uint16_t> out(rgba.size());
  std::transform(rgba.begin(), rgba.end(), out.begin(), unit16);
  return out;
}

std::vector<float> transformed(std::vector<float> uv, const TextureSource& source) {
  const auto& t = source.uv_transform;
  for (std::size_t i = 0; i < uv.size(); i += 2) {
    const float u = uv[i], v = uv[i + 1];
    uv[i] = t[0][0] * u + t[0][1] * v + t[0][2];
    uv[i + 1] = t[1][0] * u + t[1][1] * v + t[1][2];
  }
  return uv;
}

/// Sets the lists of vertices. `read` returns the floats of an attribute, `numbers` the numbers of the vertices.
template <class Read, class Numbers>
void set_vertices(const VertexValues& values, const SourceMaterial& m, const Read& read, const Numbers& numbers,
                  Primitive& out) {
  out.position = read(values.position, 3, 0.0f);
  if (values.colour) out.rgba = linear_colours(read(*values.colour, 4, 1.0f));
  if (values.uv) out.uv = transformed(read(*values.uv, 2, 0.0f), m.texture);
  if (values.normal) out.normal = vertex_normals(read(*values.normal, 3, 0.0f));
  if (values.normal_uv) out.normal_uv = transformed(read(*values.normal_uv, 2, 0.0f), m.normal_map);
  if (values.tangent) out.tangent = vertex_tangents(read(*values.tangent, 4, 0.0f));
  if (!values.ids) return;
  if (const IdTextureSource* texture = values.ids->texture()) {
    out.id_uv = transformed(read(texture->uv, 2, 0.0f), texture->coordinates);
    return;
  }
  const AccessorItems* ids = values.ids->attribute();
  out.vertex_class = ids != nullptr ? values.ids->classes_of(read(*ids, 1, 0.0f)) : values.ids->classes_of(numbers());
}

}  // namespace

std::uint64_t VertexValues::bytes_of_vertex() const {
  return vertex_bytes + (normal ? normal_bytes : 0) + (normal_uv ? uv_bytes : 0) + (tangent ? tangent_bytes : 0) +
         (ids ? (ids->texture() != nullptr ? uv_bytes : id_bytes) : 0);
}

std::vector<VertexNormal> vertex_normals(const std::vector<float>& xyz) {
  std::vector<VertexNormal> out(xyz.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = encode_vertex_normal({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
  return out;
}

std::vector<VertexTangent> vertex_tangents(const std::vector<float>& xyzw) {
  std::vector<VertexTangent> out(xyzw.size() / 4);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float* t = &xyzw[4 * i];
    const bool has_side = t[3] > 0 || t[3] < 0;
    out[i] = encode_vertex_tangent(has_side ? Vec3d{t[0], t[1], t[2]} : Vec3d{0, 0, 0}, t[3] < 0);
  }
  return out;
}

Primitive read_whole(const Corners& corners, const VertexValues& values, const SourceMaterial& material) {
  Primitive out;
  out.index = corners.of_triangles(0, corners.triangles());
  const auto read = [](const AccessorItems& items, int components, float missing) {
    return items.floats(components, missing);
  };
  const auto numbers = [&] {
    std::vector<std::uint32_t> all(values.position.count());
    std::iota(all.begin(), all.end(), std::uint32_t(0));
    return all;
  };
  set_vertices(values, material, read, numbers, out);
  return out;
}

Primitive read_part(const Corners& corners, std::uint64_t first, const VertexValues& values,
                    const SourceMaterial& material, const ClaimItems& claim) {
  const std::uint64_t triangles = std::min(corners.triangles() - first, max_part_triangles);
  claim(triangles * 3, corner_bytes, "corners of triangles");
  claim(values.position.count() / 64 + 1, UsedVertices::bytes_of_64, "flags of vertices");
  Primitive out;
  out.index = corners.of_triangles(first, triangles);
  const UsedVertices used(out.index);
  used.renumber(out.index);
  const std::span<const std::uint32_t> vertices = used.ascending();
  claim(vertices.size(), values.bytes_of_vertex(), "vertices");
  const auto read = [&](const AccessorItems& items, int components, float missing) {
    return items.floats_of(vertices, components, missing);
  };
  set_vertices(
      values, material, read, [&] { return vertices; }, out);
  return out;
}

}  // namespace gigabake
