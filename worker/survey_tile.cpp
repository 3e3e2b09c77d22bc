#include "worker/survey_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <new>
#include <span>
#include <unordered_map>
#include <utility>

#include "format/source/tile_hash.h"
#include "kernels/body/part.h"
#include "lattice/error.h"
#include "lattice/snap.h"
#include "worker/column_map.h"
#include "worker/column_span.h"
#include "worker/far_triangles.h"
#include "worker/instance_bounds.h"
#include "worker/lattice.h"
#include "worker/position_spacing.h"

namespace gigabake {
namespace {

constexpr std::size_t triangles_per_range = 16384;
/// A primitive placed so often, with so many triangles in all, is surveyed by the boxes of its placements.
constexpr std::size_t least_boxed_instances = 16;
constexpr std::uint64_t most_exact_triangles = std::uint64_t(1) << 20;
constexpr double most_crossings = 0x1p60;  ///< of one triangle or box
constexpr double farthest_voxel = 0x1p44;  ///< the snap's range is 2^53 sub-voxels

struct ThreadSurvey {
  ColumnMap map;
  std::vector<ColumnExtent> touched;  ///< by the triangle in hand
  std::uint64_t non_finite = 0, zero_area = 0, too_far = 0;
  double reach_m = 0;
};

struct SnappedVertex {
  LatticePoint p;
  bool valid;
};

/// Of a vertex that is not on the lattice: where it would be, or infinite.
std::array<double, 3> scene_position(const Primitive& primitive, std::uint32_t vertex, const Instance& instance) {
  const float* local = primitive.position.data() + 3 * std::size_t(vertex);
  std::array<double, 3> p_m{};
  for (std::size_t r = 0; r < 3; ++r) {
    const auto& m = instance.scene_from_local.m[r];
    p_m[r] = m[0] * local[0] + m[1] * local[1] + m[2] * local[2] + m[3];
  }
  return p_m;
}

/// Longest side of the box of a triangle that is not on the lattice; no number or infinite where a vertex is.
double side_m(const Primitive& primitive, const std::uint32_t* index, const Instance& instance) {
  const std::array<std::array<double, 3>, 3> p_m = {scene_position(primitive, index[0], instance),
                                                    scene_position(primitive, index[1], instance),
                                                    scene_position(primitive, index[2], instance)};
  double side = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!std::isfinite(p_m[0][c] + p_m[1][c] + p_m[2][c])) return HUGE_VAL;
    const auto [low, high] = std::minmax({p_m[0][c], p_m[1][c], p_m[2][c]});
    side = std::max(side, high - low);
  }
  return side;
}

std::vector<SnappedVertex> snap_vertices(const Primitive& primitive, const Instance& instance,
                                         const BakeParameters& parameters, const ThreadPool& pool) {
  const SnapFrame frame = snap_frame(parameters);
  const auto scene_from_local = row_major(instance.scene_from_local);
  std::vector<SnappedVertex> out(primitive.position.size() / 3);
  pool.parallel_for(out.size(), 65536, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i)
      out[i].valid = snap(frame, scene_from_local.data(), primitive.position.data() + 3 * i, out[i].p);
  });
  return out;
}

/// Of what stays on the lattice: a triangle with another vertex is dropped.
LocalReach reach_of(const Primitive& primitive, const std::vector<SnappedVertex>& vertices) {
  LocalReach reach{};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t axis = 0; vertices[i].valid && axis < 3; ++axis)
      reach[axis] = std::max(reach[axis], std::fabs(primitive.position[3 * i + axis]));
  return reach;
}

/// Twice the areas seen along x, y and z, added: of triangles on the lattice exact as long as doubles hold them.
double doubled_views(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::fabs(a[1] * b[2] - a[2] * b[1]) + std::fabs(a[2] * b[0] - a[0] * b[2]) +
         std::fabs(a[0] * b[1] - a[1] * b[0]);
}

std::uint64_t crossings_of(const LatticeTriangle& t) {
  std::array<double, 3> a{}, b{};
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = double(t.p[1][k] - t.p[0][k]);
    b[k] = double(t.p[2][k] - t.p[0][k]);
  }
  return std::uint64_t(std::min(doubled_views(a, b), most_crossings));
}

/// In its own frame, of triangles that are finite.
double area_m2(const Primitive& primitive) {
  double doubled = 0;
  for (std::size_t t = 0; t + 2 < primitive.index.size(); t += 3) {
    const float* p[3];
    for (std::size_t i = 0; i < 3; ++i) p[i] = primitive.position.data() + 3 * std::size_t(primitive.index[t + i]);
    std::array<double, 3> a{}, b{};
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = double(p[1][k]) - double(p[0][k]);
      b[k] = double(p[2][k]) - double(p[0][k]);
    }
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    const double area = std::sqrt(x * x + y * y + z * z);
    if (std::isfinite(area)) doubled += area;
  }
  return doubled / 2;
}

/// Exact for placements that scale all axes alike.
double area_scale(const Instance& instance) {
  return std::pow(std::fabs(kernels::determinant(row_major(instance.scene_from_local).data())), 2.0 / 3);
}

class TileSurveyor {
 public:
  TileSurveyor(const TileRef& tile, const BakeParameters& parameters, const ThreadPool& pool)
      : tile_(tile),
        parameters_(parameters),
        pool_(pool),
        grid_{int(std::bit_width(parameters.cell_voxels)) - 1, parameters.surface != SurfaceRule::area},
        threads_(std::size_t(pool.threads())) {}

  void add(const Primitive& primitive, const Instance& instance) {
    const std::vector<SnappedVertex> vertices = snap_vertices(primitive, instance, parameters_, pool_);
    spacing_m_ = std::max(spacing_m_, position_spacing_m(primitive, instance, reach_of(primitive, vertices)));
    pool_.parallel_for(primitive.index.size() / 3, triangles_per_range,
                       [&](std::size_t begin, std::size_t end, int thread) {
                         for (std::size_t t = begin; t < end; ++t)
                           if (!add_triangle(vertices, primitive.index.data() + 3 * t, threads_[std::size_t(thread)]))
                             add_off_lattice(side_m(primitive, primitive.index.data() + 3 * t, instance),
                                             threads_[std::size_t(thread)]);
                       });
  }

  /// As add(), of all these placements of the primitive, but for triangles that have no area. Those whose box is beyond
  /// the lattice, or so large that a triangle may reach too far, are looked at one triangle at a time: some may not.
  void add_boxes(const Primitive& primitive, std::span<const Instance* const> instances) {
    const LocalBounds bounds = bounds_of(primitive);
    const std::uint64_t triangles = primitive.index.size() / 3, non_finite = triangles_not_finite(primitive);
    const double local_area_m2 = area_m2(primitive);
    std::vector<char> is_far(instances.size(), 0);
    pool_.parallel_for(instances.size(), 1024, [&](std::size_t begin, std::size_t end, int thread) {
      ThreadSurvey& found = threads_[std::size_t(thread)];
      for (std::size_t i = begin; i < end; ++i) {
        const SceneBox box = scene_box(bounds, *instances[i], parameters_);
        const std::uint64_t crossings = crossings_of_area(local_area_m2 * area_scale(*instances[i]));
        is_far[i] =
            may_reach_too_far(box, parameters_) || (!box.is_empty() && !add_box(box, triangles, crossings, found.map));
        if (is_far[i] == 0) found.non_finite += non_finite;
      }
    });
    for (std::size_t i = 0; i < instances.size(); ++i)
      if (is_far[i] != 0) add(primitive, *instances[i]);
  }

  void finish(TileSurvey& survey) const {
    survey.spacing_m = spacing_m_;
    for (const ThreadSurvey& thread : threads_) {
      survey.non_finite += thread.non_finite;
      survey.zero_area += thread.zero_area;
      survey.too_far += thread.too_far;
      survey.reach_m = std::max(survey.reach_m, thread.reach_m);
      for (const auto& [key, column] : thread.map.columns()) survey.columns.push_back(column);
    }
    unite_columns(survey.columns);
  }

 private:
  static std::uint64_t triangles_not_finite(const Primitive& primitive) {
    const auto is_finite = [&](std::uint32_t vertex) {
      const float* p = primitive.position.data() + 3 * std::size_t(vertex);
      return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    };
    std::uint64_t count = 0;
    for (std::size_t t = 0; t + 2 < primitive.index.size(); t += 3)
      count += !std::all_of(&primitive.index[t], &primitive.index[t] + 3, is_finite);
    return count;
  }

  /// Of surface that faces all ways alike: the mean of |x| + |y| + |z| over directions is 3/2.
  std::uint64_t crossings_of_area(double surface_m2) const {
    const double voxels = 1.5 * surface_m2 / (parameters_.voxel_size_m * parameters_.voxel_size_m);
    return std::uint64_t(std::clamp(voxels * crossing_unit, 0.0, most_crossings));
  }

  /// False, with nothing added, where the box reaches beyond the lattice.
  bool add_box(const SceneBox& box, std::uint64_t triangles, std::uint64_t crossings, ColumnMap& map) const {
    std::array<VoxelSpan, 3> voxels;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto voxel = [&](double p_m) {
        return std::floor((p_m - parameters_.lattice_origin_m[c]) / parameters_.voxel_size_m);
      };
      const double first = voxel(box.low_m[c]), last = voxel(box.high_m[c]);
      if (!(first > -farthest_voxel && last < farthest_voxel)) return false;
      voxels[c] = {std::int64_t(first), std::int64_t(last)};
    }
    const auto columns = [&](VoxelSpan v) { return VoxelSpan{v.first >> grid_.cell_bits, v.last >> grid_.cell_bits}; };
    const VoxelSpan x = columns(voxels[0]), y = columns(voxels[1]);
    if (std::uint64_t(x.last - x.first) >= max_columns || std::uint64_t(y.last - y.first) >= max_columns) refuse();
    const std::uint64_t share = crossings / (std::uint64_t(x.last - x.first + 1) * std::uint64_t(y.last - y.first + 1));
    for (std::int64_t row = y.first; row <= y.last; ++row)
      for (std::int64_t column = x.first; column <= x.last; ++column) {
        map.add({column, row, voxels[2].first, voxels[2].last + 1, triangles, share});
        if (map.is_too_wide()) refuse();
      }
    return true;
  }

  [[noreturn]] void refuse() const {
    throw InputError(tile_.path, "",
                     "its triangles spread over more than " + std::to_string(max_columns) + " columns of " +
                         std::to_string(parameters_.cell_voxels) +
                         " voxels; enlarge `voxel_size_m` or `cell_voxels`, or check the unit of its coordinates");
  }

  static void add_off_lattice(double side_m, ThreadSurvey& found) {
    if (!std::isfinite(side_m)) {
      ++found.non_finite;
      return;
    }
    ++found.too_far;
    found.reach_m = std::max(found.reach_m, side_m);
  }

  /// False, with nothing counted, where a vertex is not on the lattice.
  bool add_triangle(const std::vector<SnappedVertex>& vertices, const std::uint32_t* index, ThreadSurvey& found) const {
    LatticeTriangle triangle;
    for (int i = 0; i < 3; ++i) {
      const SnappedVertex& v = vertices[index[i]];
      if (!v.valid) return false;
      std::copy(v.p.v, v.p.v + 3, triangle.p[i]);
    }
    if (!has_area(triangle)) {
      ++found.zero_area;
      return true;
    }
    if (const std::int64_t side = side_of(triangle); side > longest_side) {
      ++found.too_far;
      found.reach_m = std::max(found.reach_m, double(side) / double(subvoxels) * parameters_.voxel_size_m);
      return true;
    }
    found.touched.clear();
    const bool fits = for_each_column(triangle, grid_, max_columns, [&](std::int64_t x, std::int64_t y, VoxelSpan z) {
      found.touched.push_back({x, y, z.first, z.last + 1, 1});
    });
    if (!fits) refuse();
    for (ColumnExtent& column : found.touched) {
      column.crossings = crossings_of(triangle) / found.touched.size();
      found.map.add(column);
    }
    if (found.map.is_too_wide()) refuse();
    return true;
  }

  const TileRef& tile_;
  const BakeParameters& parameters_;
  const ThreadPool& pool_;
  ColumnGrid grid_;
  std::vector<ThreadSurvey> threads_;
  double spacing_m_ = 0;
};

/// primitive_at: gives a primitive with its triangles.
template <class PrimitiveAt>
void add_all(const TileMesh& mesh, const PrimitiveAt& primitive_at, TileSurveyor& surveyor) {
  std::vector<std::vector<const Instance*>> placed(mesh.primitives.size());
  for (const Instance& instance : mesh.instances) placed[std::size_t(instance.primitive)].push_back(&instance);
  for (std::size_t p = 0; p < placed.size(); ++p) {
    if (placed[p].empty()) continue;
    const std::shared_ptr<const Primitive> held = primitive_at(p);
    const Primitive& primitive = *held;
    if (placed[p].size() >= least_boxed_instances &&
        placed[p].size() * std::uint64_t(primitive.index.size() / 3) > most_exact_triangles)
      surveyor.add_boxes(primitive, placed[p]);
    else
      for (const Instance* instance : placed[p]) surveyor.add(primitive, *instance);
  }
}

/// For as long as its owner lives.
std::shared_ptr<const Primitive> borrowed(const Primitive& primitive) {
  return {std::shared_ptr<const Primitive>(), &primitive};
}

void take_counts(const TileMesh& mesh, TileSurvey& survey) {
  survey.triangles = mesh.counts.triangles;
  survey.skipped_points = mesh.counts.skipped_points;
  survey.skipped_lines = mesh.counts.skipped_lines;
  survey.warnings = mesh.warnings;
}

TileSurvey unreadable(std::uint32_t tile, std::string reason) {
  TileSurvey survey;
  survey.tile = tile;
  survey.error = std::move(reason);
  return survey;
}

}  // namespace

TileSurvey survey_tile(const SceneSources& sources, std::uint32_t tile, const BakeParameters& parameters,
                       const ThreadPool& pool, const TileStore* store) {
  TileSurvey survey;
  survey.tile = tile;
  const TileRef& ref = sources.tiles.at(tile);
  try {
    // First of all: the files' stamps must be older than everything that is read of them.
    TileIdentity identity = identify_tile(ref, sources.root);
    TileSurveyor surveyor(ref, parameters, pool);
    if (store != nullptr && store->may_be_large(tile)) {
      const std::shared_ptr<const LoadedTile> loaded = store->load(tile, identity.hash);
      take_counts(loaded->mesh(), survey);
      add_all(
          loaded->mesh(), [&](std::size_t p) { return loaded->whole(p); }, surveyor);
    } else {
      const TileMesh mesh = read_tile(ref, sources.root, ReadScope::positions_only);
      take_counts(mesh, survey);
      add_all(
          mesh, [&](std::size_t p) { return borrowed(mesh.primitives[p]); }, surveyor);
    }
    surveyor.finish(survey);
    survey.source = identity.hash;
    survey.files = std::move(identity.files);
    return survey;
  } catch (const std::bad_alloc&) {
    return unreadable(tile, InputError(ref.path, "", not_enough_memory).what());
  } catch (const std::exception& e) {
    return unreadable(tile, e.what());
  }
}

}  // namespace gigabake
