#include "kernels/cpu/voxelize/voxelize.h"

#include <bit>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "kernels/body/texture/texel_classes.h"
#include "kernels/body/voxelize/normal_maps.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/plane_offset.h"
#include "kernels/body/voxelize/surface.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/body/voxelize/vertex_normals.h"
#include "kernels/cpu/voxelize/brick_run.h"
#include "kernels/cpu/voxelize/brick_sums.h"
#include "kernels/cpu/voxelize/cell_lanes.h"

namespace gigabake::kernels {
namespace {

/// The data of a part that is the same for all its triangles.
struct PartSurface {
  PartArrays part;
  Surface surface;
  VoxelClass voxel_class;
  IdTextureView ids;
  const float* id_uv;
};

std::vector<PartSurface> part_surfaces(const CellInput& input, bool classes) {
  std::vector<PartSurface> out;
  for (std::size_t i = 0; i < input.parts.size; ++i) {
    const PartView& view = input.parts[i];
    const PartArrays part = part_arrays(input, view);
    out.push_back({part, surface_of(part, input.materials.data, input.textures.data), view.voxel_class,
                   classes && view.id_texture != nullptr ? *view.id_texture : IdTextureView(), view.id_uv.data});
  }
  return out;
}

/// Sets the ids of a triangle. It has none if its part has no texture of ids or its coordinates are unusable.
void set_ids(const PartSurface& from, const TextureView* textures, std::uint32_t triangle, const TrianglePlane& plane,
             TriangleIds& ids) {
  ids.texture = nullptr;
  if (from.ids.texture < 0) return;
  std::uint32_t v[3];
  float uv[6];
  triangle_vertices(from.part, triangle, v);
  if (!load_uv(from.id_uv, v, uv)) return;
  ids.texture = textures + from.ids.texture;
  ids.texels = from.ids.texels;
  const TextureMap map = make_texture_map(plane, uv, ids.texture->width, ids.texture->height);
  ids.map = {map.s0, map.su, map.sv, map.t0, map.tu, map.tv, from.ids.wrap_s, from.ids.wrap_t};
  ids.weight_scale = plane.weight_scale;
}

/// Sets the members of `s` that differ between triangles of one part.
void set_triangle(const PartArrays& part, const WindowTriangle& w, const TrianglePlane& plane, Surface& s) {
  if (s.has_vertex_rgba) load_vertex_rgba(part, w.index, s.vertex_rgba);
  if (s.texture != nullptr) s.map = texture_map(part, w.index, plane, *s.texture);
}

/// Normals of a triangle.
struct TriangleNormals {
  Vec3<std::int16_t> geometric, vertex[3];
  bool has_vertex = false;  ///< `vertex` is set
  TriangleMap map{};

  bool has_map() const { return map.texture != nullptr; }

  /// Sets the normals of a triangle. Members that its part does not use are not written: copying all of them takes as
  /// long as cutting a small triangle.
  void set(const PartArrays& part, const TextureView* textures, std::uint32_t triangle, const TrianglePlane& plane,
           const Vec3<std::int16_t>& of_triangle) {
    geometric = of_triangle;
    has_vertex = part.normal != nullptr;
    const double side = has_vertex ? load_vertex_normals(part, triangle, geometric, vertex) : 1;
    map.texture = nullptr;
    if (part.normal_map.texture >= 0) map = triangle_map(part, textures, triangle, plane, side);
  }
};

/// The voxelizer of one thread. Its buffers are reused for all its bricks.
class BrickWalker {
 public:
  BrickWalker(std::span<const WindowTriangle> triangles, const std::vector<PartSurface>& parts,
              const TextureView* textures, const CellParameters& parameters)
      : triangles_(triangles),
        parts_(parts),
        textures_(textures),
        rule_(parameters.surface),
        tables_(TableStore::host().view()),
        sums_(parameters.classes) {}

  void walk(const Pair* begin, const Pair* end, BrickRun& run) {
    const std::uint64_t key = brick_of(*begin);
    const Vec3<std::int32_t> corner = brick_corner(key);
    for (const Pair* pair = begin; pair != end; ++pair) {
      const WindowTriangle& t = triangles_[triangle_of(*pair)];
      with_integer_for(t, [&]<class I>(I) { add_triangle<I>(t, corner); });
    }
    sums_.resolve_to(run, key, tables_);
  }

  std::uint64_t fragments() const { return fragments_; }

 private:
  template <class I>
  void add_triangle(const WindowTriangle& w, const Vec3<std::int32_t>& corner) {
    const BrickTriangle<I> t = make_brick_triangle<I>(w, corner);
    std::uint64_t slab[8];
    touched_voxels(t, rule_, slab);
    if ((slab[0] | slab[1] | slab[2] | slab[3] | slab[4] | slab[5] | slab[6] | slab[7]) == 0) return;
    const TrianglePlane plane = make_plane(t);
    const PartArrays& part = parts_[w.part].part;
    if (w.part != surface_part_) surface_ = parts_[w.part].surface, surface_part_ = w.part;
    set_triangle(part, w, plane, surface_);
    normals_.set(part, textures_, w.index, plane, triangle_normal(part, w.index, t));
    if (surface_.look() == ShadingRate::linear) linear_ = make_linear_colour(surface_, plane);
    set_ids(parts_[w.part], textures_, w.index, plane, ids_);
    sums_.begin_triangle(ids_.texture == nullptr ? std::optional(parts_[w.part].voxel_class) : std::nullopt);
    for (int i = 0; i < 8; ++i)
      if (slab[i] != 0) add_slab(plane, surface_, t.axis, i, slab[i]);
    sums_.end_triangle();
  }

  /// Adds the fragments of slab `w`. Bit u + 8v of `cells` is set if the triangle overlaps cell (u, v) of the slab.
  void add_slab(const TrianglePlane& plane, const Surface& surface, int axis, int w, std::uint64_t cells) {
    const ShadingRate look = surface.look();
    int voxel[64];
    lanes_.count = 0;
    for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1) {
      const int cell = std::countr_zero(rest), u = cell & 7, v = cell >> 3;
      voxel[lanes_.count] = voxel_of_cell(axis, w, cell);
      lanes_.u[lanes_.count] = double(u - plane.anchor[0]);
      lanes_.v[lanes_.count] = double(v - plane.anchor[1]);
      ++lanes_.count;
    }
    const double slab = double(w - plane.anchor[2]);
    const SlabPolygon polygon = cut_slab(plane, slab);
    offset_ = make_plane_offset(plane, normals_.geometric, axis, slab);
    measure(plane, polygon, look);
    if (look == ShadingRate::linear)
      add_linear_cells(plane, polygon, voxel);
    else
      add_cells(plane, polygon, surface, voxel);
    fragments_ += std::uint64_t(lanes_.count);
  }

  void measure(const TrianglePlane& plane, const SlabPolygon& polygon, ShadingRate look) {
    if (look == ShadingRate::varying || normals_.has_map()) return measure_second_moments(plane, polygon, lanes_);
    look == ShadingRate::linear || normals_.has_vertex ? measure_moments(plane, polygon, lanes_)
                                                       : measure_areas(plane, polygon, lanes_);
  }

  CellMoments moments_of(int lane) const {
    return {lanes_.area[lane], lanes_.moment_u[lane], lanes_.moment_v[lane], 0, 0, 0};
  }

  CellMoments second_moments_of(int i) const {
    return {lanes_.area[i],      lanes_.moment_u[i],  lanes_.moment_v[i],
            lanes_.moment_uu[i], lanes_.moment_uv[i], lanes_.moment_vv[i]};
  }

  FragmentShape shape_of(const TrianglePlane& plane, const SlabPolygon& polygon, int i) const {
    return fragment_shape(plane, second_moments_of(i), lanes_.u[i], lanes_.v[i], polygon.u, polygon.v, polygon.count);
  }

  /// Returns the normal of a fragment. If the triangle has vertex normals or a normal map, its moments must have been
  /// measured.
  Vec3<std::int16_t> normal_of(const TrianglePlane& plane, const SlabPolygon& polygon, int i) const {
    const Vec3<std::int16_t> smooth = normals_.has_vertex
                                          ? mean_normal(normals_.vertex, plane, moments_of(i), lanes_.u[i], lanes_.v[i])
                                          : normals_.geometric;
    if (!normals_.has_map()) return smooth;
    return mapped_normal(normals_.map, smooth, normals_.geometric, plane, shape_of(plane, polygon, i), tables_);
  }

  /// Adds the fragment of a lane, and the areas of its classes if its triangle has ids in a texture.
  void add(const TrianglePlane& plane, const SlabPolygon& polygon, int i, int voxel, const Fragment& fragment) {
    sums_.add(voxel, fragment);
    if (ids_.texture == nullptr || !has_class_weight(fragment.alpha)) return;
    const double u = lanes_.u[i], v = lanes_.v[i];
    const FragmentShape shape{{0, 0}, lanes_.area[i], 0, 0, 0, u, v, polygon.u, polygon.v, polygon.count};
    for_each_class(ids_, shape, small_centroid(plane, u, v), fragment.weight,
                   [&](VoxelClass of_texels, std::int64_t area) { sums_.add_area(voxel, of_texels, area); });
  }

  void add_linear_cells(const TrianglePlane& plane, const SlabPolygon& polygon, const int voxel[64]) {
    for (int i = 0; i < lanes_.count; ++i)
      add(plane, polygon, i, voxel[i],
          linear_fragment(linear_, lanes_.u[i], lanes_.v[i], moments_of(i), plane.weight_scale,
                          normal_of(plane, polygon, i), offset_in(offset_, lanes_.u[i], lanes_.v[i])));
  }

  void add_cells(const TrianglePlane& plane, const SlabPolygon& polygon, const Surface& surface, const int voxel[64]) {
    Rgba16 rgba;
    const bool varies = surface.look() != ShadingRate::flat, opaque = surface.is_opaque();
    if (!varies) rgba = shade<false>(surface, plane, {}, tables_);
    for (int i = 0; i < lanes_.count; ++i) {
      if (varies) {
        const FragmentShape shape = shape_of(plane, polygon, i);
        rgba = opaque ? shade<true>(surface, plane, shape, tables_) : shade<false>(surface, plane, shape, tables_);
      }
      add(plane, polygon, i, voxel[i],
          fragment_of_colour(weight_of(lanes_.area[i], plane.weight_scale), rgba.c, normal_of(plane, polygon, i),
                             offset_in(offset_, lanes_.u[i], lanes_.v[i])));
    }
  }

  std::span<const WindowTriangle> triangles_;
  const std::vector<PartSurface>& parts_;
  const TextureView* textures_;
  SurfaceRule rule_;
  Tables tables_;
  BrickSums sums_;
  CellLanes lanes_;
  Surface surface_;                          ///< of the current triangle
  std::uint32_t surface_part_ = UINT32_MAX;  ///< part of `surface_`
  LinearColour linear_;                      ///< colour of the current triangle, if its shading rate is linear
  TriangleNormals normals_;                  ///< of the current triangle
  PlaneOffset offset_;                       ///< of the current triangle in the current slab
  TriangleIds ids_;                          ///< of the current triangle
  std::uint64_t fragments_ = 0;
};

/// Returns the index of each brick's first pair. The last entry is the number of pairs.
std::vector<std::size_t> brick_starts(std::span<const Pair> pairs) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (i == 0 || brick_of(pairs[i]) != brick_of(pairs[i - 1])) starts.push_back(i);
  starts.push_back(pairs.size());
  return starts;
}

}  // namespace

void voxelize(const CellInput& input, std::span<const WindowTriangle> triangles, const CellParameters& parameters,
              std::span<const Pair> pairs, const ThreadPool& pool, Level& level, CellStats& stats) {
  const std::vector<PartSurface> parts = part_surfaces(input, parameters.classes);
  const std::vector<std::size_t> starts = brick_starts(pairs);
  const std::size_t bricks = starts.size() - 1;
  std::vector<BrickRun> runs((bricks + bricks_per_run - 1) / bricks_per_run,
                             BrickRun(parameters.normals, has_finest_planes(parameters)));
  std::vector<std::unique_ptr<BrickWalker>> walkers(pool.threads());
  pool.parallel_for(bricks, bricks_per_run, [&](std::size_t begin, std::size_t end, int thread) {
    if (!walkers[thread])
      walkers[thread] = std::make_unique<BrickWalker>(triangles, parts, input.textures.data, parameters);
    for (std::size_t b = begin; b < end; ++b)
      walkers[thread]->walk(pairs.data() + starts[b], pairs.data() + starts[b + 1], runs[b / bricks_per_run]);
  });
  for (const auto& walker : walkers)
    if (walker) stats.fragments += walker->fragments();
  append(level, runs, pool);
}

}  // namespace gigabake::kernels
