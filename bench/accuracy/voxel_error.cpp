#include "bench/accuracy/voxel_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "bench/accuracy/clipped_triangle.h"
#include "bench/accuracy/colour_spaces.h"
#include "bench/accuracy/reference_voxels.h"
#include "bench/accuracy/sampled_voxels.h"
#include "bench/accuracy/surface_points.h"
#include "bench/schedule_model.h"
#include "core/base/thread_pool.h"
#include "core/math/octahedral.h"
#include "kernels/body/tables.h"

namespace gigabake::bench {
namespace {

/// A bound of the movement of a snapped vertex, per axis and in total.
constexpr double snap = 1.0 / 256;
constexpr double half_diagonal = 0.8660254037844386;
constexpr double max_distance = 64;
constexpr double min_area = 1e-4, min_alpha = 0.1;

double sum_of_squares(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

/// Returns the distance from a point to the nearest voxel in the maximum norm, in voxels; 2 if none is within 1.
double distance_to_voxels(const ReferenceVoxels& voxels, const Vec3d& p) {
  const Vec3d low{std::floor(p[0]), std::floor(p[1]), std::floor(p[2])};
  const Vec3d inside = p - low;
  const Vec3i64 in = Vec3i64(low) - voxels.origin();
  if (voxels.exists(in)) return 0;
  double nearest = 2;
  for (int i = 0; i < 27; ++i) {
    const Vec3i64 step{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    double distance = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if (step[a] != 0) distance = std::max(distance, step[a] < 0 ? inside[a] : 1 - inside[a]);
    if (distance < nearest && voxels.exists(in + step)) nearest = distance;
  }
  return nearest;
}

void judge_points(const ReferenceVoxels& voxels, const std::vector<Vec3d>& points, double edge, VoxelError& error) {
  std::uint64_t missed = 0, by_half = 0, by_one = 0;
  for (const Vec3d& p : points) {
    const double distance = distance_to_voxels(voxels, p / edge);
    missed += distance > snap;
    by_half += distance > 0.5;
    by_one += distance > 1;
  }
  const double all = double(std::max<std::size_t>(1, points.size()));
  error.points = points.size();
  error.missed = double(missed) / all;
  error.missed_by_half = double(by_half) / all;
  error.missed_by_one = double(by_one) / all;
}

struct SourceColour {
  double alpha = 0, texels = 0;
  Rgb straight{};
};

struct Verdict {
  double distance = max_distance;  ///< from the centre
  bool is_touched = false;
  std::optional<double> angle_deg;
  std::optional<SourceColour> source;
};

/// Compares a voxel with the triangles around it.
class VoxelComparison {
 public:
  VoxelComparison(const ReferenceCaster& caster, double edge, bool has_normals, const VoxelErrorSample& sample)
      : caster_(caster), source_(caster.triangles()), edge_(edge), has_normals_(has_normals), sample_(sample) {}

  Verdict judge(const SampledVoxel& voxel, std::uint64_t number) const {
    const Vec3d lowest = Vec3d(voxel.at) * edge_, centre = lowest + Vec3d::all(edge_ / 2);
    const std::vector<Nearby> nearby = around(centre);
    Verdict verdict;
    for (const Nearby& t : nearby) verdict.distance = std::min(verdict.distance, t.distance / edge_);
    if (has_normals_) verdict.angle_deg = angle(nearby, verdict.distance * edge_, voxel.normal);
    const double margin = snap * edge_;
    const Vec3d wider = lowest - Vec3d::all(margin);
    verdict.is_touched = std::any_of(nearby.begin(), nearby.end(), [&](const Nearby& t) {
      return !clip_to_cube(t.corners, wider, edge_ + 2 * margin).empty();
    });
    verdict.source = colour(nearby, lowest, number);
    return verdict;
  }

 private:
  struct Nearby {
    TriangleName name;
    Corners corners;
    double distance;  ///< from the voxel's centre
  };
  struct Fragment {
    TriangleName name;
    std::vector<ClippedCorner> polygon;
    double area;
  };

  /// Returns the triangles whose distance from the voxel's centre is at most the voxel's edge; they include all
  /// triangles in the voxel. If there are none, doubles the distance, up to max_distance.
  std::vector<Nearby> around(const Vec3d& centre) const {
    std::vector<Nearby> nearby;
    for (double radius = edge_; nearby.empty() && radius <= max_distance * edge_; radius *= 2)
      for (const TriangleName name : caster_.near(centre, radius)) {
        const Corners corners = source_.corners(name.part, name.triangle);
        const Vec3d n = normal_of(corners);
        if (!(dot(n, n) > 0)) continue;
        const double distance = distance_to(corners, centre);
        if (distance <= radius) nearby.push_back({name, corners, distance});
      }
    return nearby;
  }

  /// Returns the angle between the stored normal and the normal of the nearest triangle. If several triangles are
  /// equally near, returns the minimum.
  std::optional<double> angle(const std::vector<Nearby>& nearby, double nearest,
                              const std::array<std::int8_t, 2>& stored) const {
    const Vec3d n = Vec3d::from(unit_normal(stored.data()));
    std::optional<double> minimum;
    for (const Nearby& t : nearby) {
      if (t.distance > nearest + snap * edge_) continue;
      Vec3d m = normal_of(t.corners);
      if (source_.is_mirrored(t.name.part)) m = m * -1;
      const double cosine = dot(n, m) / length(m);
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
      if (!minimum || angle < *minimum) minimum = angle;
    }
    return minimum;
  }

  /// Returns the reference colour of the voxel: the mean over all surface in it.
  std::optional<SourceColour> colour(const std::vector<Nearby>& nearby, const Vec3d& lowest,
                                     std::uint64_t number) const {
    std::vector<Fragment> fragments;
    double area = 0;
    for (const Nearby& t : nearby) {
      Fragment f{t.name, clip_to_cube(t.corners, lowest, edge_), 0};
      f.area = area_of(f.polygon);
      area += f.area;
      if (f.area > 0) fragments.push_back(std::move(f));
    }
    if (area < min_area * edge_ * edge_) return {};
    SourceColour sum;
    std::uint64_t drawn = number << 20;
    for (const Fragment& f : fragments) add(f, area, sum, drawn);
    for (double& c : sum.straight) c = sum.alpha > 0 ? c / sum.alpha : 0;
    return sum;
  }

  void add(const Fragment& f, double area, SourceColour& sum, std::uint64_t& drawn) const {
    const double twice_area = length(normal_of(source_.corners(f.name.part, f.name.triangle)));
    const double texels_per_area = 2 * source_.texels(f.name.part, f.name.triangle) / twice_area;
    sum.texels += f.area / area * std::sqrt(texels_per_area) * edge_;
    const int points = std::max(1, int(std::lround(sample_.texels * f.area / area)));
    for (int k = 0; k < points; ++k) {
      const double u = (k + uniform(sample_.seed, drawn++)) / points, v = uniform(sample_.seed, drawn++);
      const ClippedCorner p = point_in(f.polygon, u, v);
      const std::array<float, 4> c = source_.colour({f.name.part, f.name.triangle, float(p.second), float(p.third)});
      const double weight = f.area / area / points;
      for (std::size_t i = 0; i < 3; ++i) sum.straight[i] += weight * c[i];
      sum.alpha += weight * c[3];
    }
  }

  const ReferenceCaster& caster_;
  const SourceTriangles& source_;
  double edge_;
  bool has_normals_;
  const VoxelErrorSample& sample_;
};

/// Accumulates the errors of colour and alpha.
class ColourSum {
 public:
  void add(const SourceColour& source, const std::array<std::uint8_t, 4>& rgba) {
    const double alpha = rgba[3] / 255.0;
    ++voxels_;
    texels_ += source.texels;
    bias_ += alpha - source.alpha;
    alpha_squares_ += (alpha - source.alpha) * (alpha - source.alpha);
    if (std::min(alpha, source.alpha) < min_alpha) return;
    ++colours_;
    Rgb stored;
    for (std::size_t c = 0; c < 3; ++c)
      stored[c] = kernels::TableStore::host().view().linear_from_srgb[rgba[c]] / 65535.0;
    colour_squares_ += sum_of_squares(stored, source.straight) / 3;
    delta_e_ += std::sqrt(sum_of_squares(cie_lab(stored), cie_lab(source.straight)));
  }
  void to(VoxelError& error) const {
    const double voxels = double(std::max<std::uint64_t>(1, voxels_)),
                 colours = double(std::max<std::uint64_t>(1, colours_));
    error.coloured = voxels_;
    error.texels = texels_ / voxels;
    error.alpha_bias = bias_ / voxels;
    error.rms_alpha = std::sqrt(alpha_squares_ / voxels);
    error.rms_colour = std::sqrt(colour_squares_ / colours);
    error.delta_e = delta_e_ / colours;
  }

 private:
  std::uint64_t voxels_ = 0, colours_ = 0;
  double texels_ = 0, bias_ = 0, alpha_squares_ = 0, colour_squares_ = 0, delta_e_ = 0;
};

void add_angles(std::vector<double> angles, VoxelError& error) {
  if (angles.empty()) return;
  std::sort(angles.begin(), angles.end());
  for (const double angle : angles) error.normal_deg += angle / double(angles.size());
  error.normal_99_deg = angles[std::size_t(0.99 * double(angles.size() - 1))];
}

void sum_up(const std::vector<SampledVoxel>& voxels, const std::vector<Verdict>& verdicts, VoxelError& error) {
  const double one = 1.0 / double(std::max<std::size_t>(1, voxels.size()));
  ColourSum colours;
  std::vector<double> angles;
  error.voxels = voxels.size();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Verdict& v = verdicts[i];
    error.extra += v.is_touched ? 0 : one;
    error.beyond_half += v.distance > 0.5 + snap ? one : 0;
    error.beyond_whole += v.distance > half_diagonal + snap ? one : 0;
    error.max_distance = std::max(error.max_distance, v.distance);
    if (v.angle_deg) angles.push_back(*v.angle_deg);
    if (v.source) colours.add(*v.source, voxels[i].rgba);
  }
  colours.to(error);
  add_angles(std::move(angles), error);
}

}  // namespace

VoxelError voxel_error(const ReferenceCaster& caster, const std::filesystem::path& scene, int coarser,
                       const VoxelErrorSample& sample, int threads) {
  const SceneDescription description = read_scene(scene);
  VoxelError error;
  judge_points(ReferenceVoxels(description, scene, 0), surface_points(caster.triangles(), sample.points, sample.seed),
               coarser, error);
  const std::vector<SampledVoxel> voxels = sample_voxels(description, scene, sample.voxels, sample.seed);
  const VoxelComparison judge(caster, coarser, description.has_normals, sample);
  std::vector<Verdict> verdicts(voxels.size());
  ThreadPool(threads).parallel_for(voxels.size(), 256, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) verdicts[i] = judge.judge(voxels[i], i);
  });
  sum_up(voxels, verdicts, error);
  return error;
}

}  // namespace gigabake::bench
