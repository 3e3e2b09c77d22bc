#include "worker/edit/edited_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "worker/edit/polygon_pieces.h"

namespace gigabake {
namespace {

using CornerIndices = std::array<std::uint32_t, 3>;

/// Returns the inverse of an affine map; nullopt if it flattens space.
std::optional<Affine<Local, Scene>> inverse_of(const Affine<Scene, Local>& a) {
  const double determinant = a.linear_determinant();
  if (!(std::fabs(determinant) > 0)) return std::nullopt;
  Affine<Local, Scene> out;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      out.m[r][c] = (a.m[r1][c1] * a.m[r2][c2] - a.m[r1][c2] * a.m[r2][c1]) / determinant;
    }
  for (std::size_t r = 0; r < 3; ++r)
    out.m[r][3] = -(out.m[r][0] * a.m[0][3] + out.m[r][1] * a.m[1][3] + out.m[r][2] * a.m[2][3]);
  return out;
}

/// Returns the weighted sum of the values at three corners. `value(corner)` returns an array of N numbers.
template <std::size_t N, class Value>
std::array<double, N> mixed(const CornerIndices& corners, const std::array<double, 3>& weight, const Value& value) {
  std::array<double, N> sum{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (weight[i] == 0) continue;  // the value may be NaN
    const std::array<double, N> at = value(corners[i]);
    for (std::size_t c = 0; c < N; ++c) sum[c] += weight[i] * at[c];
  }
  return sum;
}

template <std::size_t N, class T>
auto values_of(const std::vector<T>& array) {
  return [&array](std::uint32_t corner) {
    std::array<double, N> out;
    for (std::size_t c = 0; c < N; ++c) out[c] = double(array[N * corner + c]);
    return out;
  };
}

template <std::size_t N>
void add_mixed(const std::vector<float>& from, const CornerIndices& corners, const std::array<double, 3>& weight,
               std::vector<float>& to) {
  if (from.empty()) return;
  for (const double v : mixed<N>(corners, weight, values_of<N>(from))) to.push_back(float(v));
}

std::array<double, 3> direction_of(const VertexNormal& code) {
  if (code[0] == no_vertex_normal) return {};
  const Vec3d n = decode_vertex_normal(code.data());
  const double size = length(n);
  return {n[0] / size, n[1] / size, n[2] / size};
}

/// Applies one edit to the triangles of a mesh.
class MeshEditor {
 public:
  MeshEditor(const Primitive& mesh, const Affine<Scene, Local>& scene_from_local, const SourceEditInScene& edit)
      : mesh_(mesh), scene_from_local_(scene_from_local), local_from_scene_(inverse_of(scene_from_local)), edit_(edit) {
    out_.position_step = mesh.position_step, out_.shares_uv = mesh.shares_uv, out_.material = mesh.material;
  }

  /// Returns the edited mesh; nullopt if the edit changes nothing.
  std::optional<Primitive> run() {
    for (std::size_t t = 0; t < mesh_.index.size(); t += 3)
      add({mesh_.index[t], mesh_.index[t + 1], mesh_.index[t + 2]});
    if (!is_changed_) return std::nullopt;
    return std::move(out_);
  }

 private:
  Point<Scene> in_scene(std::uint32_t corner) const {
    const float* p = &mesh_.position[3 * std::size_t(corner)];
    return scene_from_local_({double(p[0]), double(p[1]), double(p[2])});
  }

  void add(const CornerIndices& corners) {
    std::array<Point<Scene>, 3> points;
    SceneRange box;
    bool is_finite = true;
    for (std::size_t i = 0; i < 3; ++i) {
      points[i] = in_scene(corners[i]);
      const std::array<double, 3> p{points[i].x, points[i].y, points[i].z};
      for (std::size_t c = 0; c < 3; ++c) {
        is_finite = is_finite && std::isfinite(p[c]);
        box.low[c] = i == 0 ? p[c] : std::min(box.low[c], p[c]),
        box.high[c] = i == 0 ? p[c] : std::max(box.high[c], p[c]);
      }
    }
    if (!is_finite) return add_whole(corners, false);  // the kernels count and drop it
    const AreaOverlap overlap = edit_.overlap(box);
    if (overlap != AreaOverlap::border) return add_whole(corners, overlap == AreaOverlap::inside);
    cut(corners, points);
  }

  bool is_kept(bool is_inside) const { return edit_.moves() || is_inside == (edit_.type() == SourceEditType::inside); }
  bool is_moved(bool is_inside) const { return is_inside && edit_.moves(); }

  void add_whole(const CornerIndices& corners, bool is_inside) {
    is_changed_ = is_changed_ || !is_kept(is_inside) || is_moved(is_inside);
    if (!is_kept(is_inside)) return;
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, 3> weight{};
      weight[i] = 1;
      add_corner(corners, weight, is_inside);
    }
  }

  void cut(const CornerIndices& corners, const std::array<Point<Scene>, 3>& points) {
    std::array<std::array<double, 2>, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = edit_.in_plane(points[i]);
    const std::vector<TrianglePiece> pieces = pieces_of(triangle, edit_.polygon());
    const auto differs = [&](const TrianglePiece& piece) { return piece.is_inside != pieces[0].is_inside; };
    if (std::none_of(pieces.begin(), pieces.end(), differs))
      return add_whole(corners, !pieces.empty() && pieces[0].is_inside);
    is_changed_ = true;
    for (const TrianglePiece& piece : pieces) {
      if (!is_kept(piece.is_inside)) continue;
      for (std::size_t i = 1; i + 1 < piece.corners.size(); ++i)
        for (const std::size_t at : {std::size_t(0), i, i + 1})
          add_corner(corners, piece.corners[at].weight, piece.is_inside);
    }
  }

  /// Appends a corner of a triangle to the result. A weight of 1 copies all values of a corner.
  void add_corner(const CornerIndices& corners, const std::array<double, 3>& weight, bool is_inside) {
    out_.index.push_back(std::uint32_t(out_.position.size() / 3));
    add_position(corners, weight, is_moved(is_inside));
    add_mixed<2>(mesh_.uv, corners, weight, out_.uv);
    add_mixed<2>(mesh_.normal_uv, corners, weight, out_.normal_uv);
    add_mixed<2>(mesh_.id_uv, corners, weight, out_.id_uv);
    if (!mesh_.rgba.empty())
      for (const double v : mixed<4>(corners, weight, values_of<4>(mesh_.rgba)))
        out_.rgba.push_back(std::uint16_t(std::clamp(std::floor(v + 0.5), 0.0, 65535.0)));
    const auto copied = std::find(weight.begin(), weight.end(), 1.0);
    const auto nearest = std::size_t(std::max_element(weight.begin(), weight.end()) - weight.begin());
    if (!mesh_.normal.empty()) {
      const auto direction = [&](std::uint32_t corner) { return direction_of(mesh_.normal[corner]); };
      const std::array<double, 3> n = mixed<3>(corners, weight, direction);
      const VertexNormal none{no_vertex_normal, no_vertex_normal};
      const bool is_flat = is_inside && edit_.type() == SourceEditType::flatten;
      out_.normal.push_back(is_flat                  ? none  // the plane of the moved triangle
                            : copied != weight.end() ? mesh_.normal[corners[nearest]]
                                                     : encode_vertex_normal({n[0], n[1], n[2]}));
    }
    if (!mesh_.tangent.empty()) out_.tangent.push_back(mesh_.tangent[corners[nearest]]);
  }

  void add_position(const CornerIndices& corners, const std::array<double, 3>& weight, bool is_moved) {
    std::array<double, 3> p = mixed<3>(corners, weight, values_of<3>(mesh_.position));
    if (is_moved && local_from_scene_) {
      const Point<Scene> at = scene_from_local_({p[0], p[1], p[2]});
      const Point<Local> moved = (*local_from_scene_)(edit_.moved(at));
      p = {moved.x, moved.y, moved.z};
    }
    for (const double v : p) out_.position.push_back(float(v));
  }

  const Primitive& mesh_;
  const Affine<Scene, Local>& scene_from_local_;
  const std::optional<Affine<Local, Scene>> local_from_scene_;
  const SourceEditInScene& edit_;
  bool is_changed_ = false;
  Primitive out_;
};

std::uint64_t bytes_of(const Primitive& p) {
  return 4 * (p.position.capacity() + p.index.capacity() + p.uv.capacity() + p.normal_uv.capacity() +
              p.id_uv.capacity() + p.normal.capacity() + p.tangent.capacity()) +
         2 * p.rgba.capacity();
}

}  // namespace

std::shared_ptr<const Primitive> edited_mesh(std::shared_ptr<const Primitive> mesh,
                                             const Affine<Scene, Local>& scene_from_local,
                                             const SourceEditsInScene& edits, MemoryClaim& memory) {
  for (const SourceEditInScene& edit : edits) {
    std::optional<Primitive> changed = MeshEditor(*mesh, scene_from_local, edit).run();
    if (!changed) continue;
    if (changed->index.empty()) return nullptr;
    memory.add(bytes_of(*changed), "edits", "the edited triangles of a source");
    mesh = std::make_shared<const Primitive>(*std::move(changed));
  }
  return mesh;
}

}  // namespace gigabake
