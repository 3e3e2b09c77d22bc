#include "bench/accuracy/reference_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/accuracy/embree/rtcore.h"
#include "bench/schedule_model.h"
#include "core/base/thread_pool.h"

namespace gigabake::bench {
namespace {

struct Released {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Released>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, Released>;

void check(RTCDevice device, const char* call) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) throw std::runtime_error(std::string(call) + ": Embree error " + std::to_string(error));
}

void add_part(RTCDevice device, RTCScene scene, const SourceTriangles& triangles, std::size_t part) {
  const std::vector<float> position = triangles.positions(part);
  const Span<const std::uint32_t> index = triangles.indices(part);
  if (index.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, position.size() / 3);
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, index.size / 3);
  check(device, "rtcSetNewGeometryBuffer");
  std::copy(position.begin(), position.end(), static_cast<float*>(vertices));
  std::copy_n(index.data, index.size, static_cast<std::uint32_t*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, unsigned(part));
  rtcReleaseGeometry(geometry);
}

Vec3d unit(const Vec3d& v) { return v / std::hypot(v[0], v[1], v[2]); }

/// Returns the unit direction through an image position in pixels. kernels::line_of_sight() supports only pixel
/// centres.
Vec3d direction_through(const kernels::CastCamera& camera, double x, double y) {
  const double sx = 2 * x / camera.width - 1, sy = 1 - 2 * y / camera.height;
  return unit(Vec3d::from(camera.forward) + (Vec3d::from(camera.right) * sx + Vec3d::from(camera.up) * sy));
}

/// Returns the distance at which a ray enters the box; nullopt if it misses the box.
std::optional<double> entry(const TriangleBox& box, const Vec3d& origin, const Vec3d& direction) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    if (direction[a] == 0) {
      if (origin[a] < box.min[a] || origin[a] > box.max[a]) return {};
      continue;
    }
    const double p = (box.min[a] - origin[a]) / direction[a], q = (box.max[a] - origin[a]) / direction[a];
    enter = std::max(enter, std::min(p, q));
    leave = std::min(leave, std::max(p, q));
  }
  // Due to rounding, a ray that touches the box's side may seem to miss the box.
  if (enter > leave + 1e-6 * std::fabs(leave)) return {};
  return enter;
}

/// Surfaces count as one surface if their distance from each other is below this fraction of their distance from the
/// box's side.
constexpr float apart = 1e-6f;
/// Transmittance below which surfaces behind are not visible.
constexpr float dark = 1e-4f;

/// Transforms a vector to the lattice from a frame whose z axis is the unit vector `axis`.
Vec3d around(const Vec3d& axis, double x, double y, double z) {
  const Vec3d other = std::fabs(axis[0]) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = unit(cross(axis, other)), v = cross(axis, u);
  return u * x + v * y + axis * z;
}

/// Returns a cosine-weighted direction of the hemisphere around `axis`. `a` and `b` are uniform in 0 … 1.
Vec3d by_cosine(const Vec3d& axis, double a, double b) {
  const double level = std::sqrt(a), turn = 2 * std::numbers::pi * b;
  return around(axis, level * std::cos(turn), level * std::sin(turn), std::sqrt(1 - a));
}

/// The sun's disc and the sky, with the random numbers of one ray.
struct SunAndSky {
  kernels::CastLight light;
  double radius = 0;  ///< tangent of the disc's half angle; 0: no shadows
  std::uint64_t seed = 0;
  mutable std::uint64_t next = 0;

  double random() const { return uniform(seed, next++); }
  Vec3d sun() const { return unit(Vec3d::from(light.to_sun)); }
  Vec3d point_of_sun() const {
    const double level = radius * std::sqrt(random()), turn = 2 * std::numbers::pi * random();
    return unit(around(sun(), level * std::cos(turn), level * std::sin(turn), 1));
  }
};

/// Distance in voxels from the lit side of a triangle at which shadow rays start.
constexpr double off_surface = 1e-3;

}  // namespace

struct ReferenceCaster::State {
  SourceTriangles triangles;
  ThreadPool pool;
  Device device;
  EmbreeScene scene;

  State(SourceTriangles source, int threads) : triangles(std::move(source)), pool(threads) {
    device.reset(rtcNewDevice(("threads=" + std::to_string(threads)).c_str()));
    if (!device) throw std::runtime_error("rtcNewDevice: Embree error " + std::to_string(rtcGetDeviceError(nullptr)));
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t part = 0; part < triangles.parts(); ++part) add_part(device.get(), scene.get(), triangles, part);
    rtcCommitScene(scene.get());
    check(device.get(), "rtcCommitScene");
  }

  /// Returns a ray that starts close to where it enters the box, because Embree's distances are float.
  std::optional<RTCRayHit> ray(const Vec3d& origin, const Vec3d& direction, double& before_box) const {
    const std::optional<double> enter = entry(triangles.box(), origin, direction);
    if (!enter) return {};
    before_box = std::max(0.0, *enter - 1);
    RTCRayHit hit{};
    const auto start = Vec3<float>(origin + direction * before_box - triangles.middle());
    hit.ray.org_x = start[0], hit.ray.org_y = start[1], hit.ray.org_z = start[2];
    hit.ray.dir_x = float(direction[0]), hit.ray.dir_y = float(direction[1]), hit.ray.dir_z = float(direction[2]);
    hit.ray.mask = ~0u;
    return hit;
  }

  /// Finds the next triangle beyond tnear; returns false if there is none.
  bool next(RTCRayHit& hit) const {
    hit.ray.tfar = std::numeric_limits<float>::infinity();
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect(scene.get(), hit);
    return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

  /// Returns the fraction of light that reaches `origin` from `direction`.
  float through(const Vec3d& origin, const Vec3d& direction) const {
    double before_box = 0;
    std::optional<RTCRayHit> hit = ray(origin, direction, before_box);
    float left = 1;
    while (hit && left > dark && next(*hit)) {
      left *= 1 - triangles.colour({hit->hit.geomID, hit->hit.primID, hit->hit.u, hit->hit.v})[3];
      hit->ray.tnear = hit->ray.tfar * (1 + apart) + apart;
    }
    return left;
  }

  /// Returns the colour of a hit, lit on the side that a ray of this direction meets.
  std::array<float, 4> lit_colour(const RTCHit& hit, const Vec3d& at, const Vec3d& direction,
                                  const SunAndSky& from) const {
    const kernels::CastLight& light = from.light;
    std::array<float, 4> c = triangles.colour({hit.geomID, hit.primID, hit.u, hit.v});
    const Vec3d outside = triangles.outside(hit.geomID, hit.primID);
    const Vec3d n = dot(outside, direction) > 0 ? outside * -1.0 : outside;
    double sun = std::max(dot(n, from.sun()), 0.0), up = (1 + n[2]) / 2;
    if (from.radius > 0) {
      const Vec3d above = at + n * off_surface;
      if (sun > 0) sun *= double(through(above, from.point_of_sun()));
      const double a = from.random(), b = from.random();
      const Vec3d to_sky = by_cosine(n, a, b);
      up = to_sky[2] > 0 ? double(through(above, to_sky)) : 0;
    }
    for (std::size_t k = 0; k < 3; ++k)
      c[k] *= float(light.sun[k] * sun + light.sky[k] * up + light.ground[k] * (1 - up));
    return c;
  }

  std::array<float, 4> radiance(const Vec3d& origin, const Vec3d& direction, const SunAndSky& from) const {
    std::array<float, 4> sum{};
    double before_box = 0;
    std::optional<RTCRayHit> hit = ray(origin, direction, before_box);
    while (hit && sum[3] < 1 - dark && next(*hit)) {
      const Vec3d at = origin + direction * (before_box + double(hit->ray.tfar));
      const std::array<float, 4> c = lit_colour(hit->hit, at, direction, from);
      const float left = 1 - sum[3];
      for (std::size_t k = 0; k < 4; ++k) sum[k] += left * c[k];
      hit->ray.tnear = hit->ray.tfar * (1 + apart) + apart;
    }
    return sum;
  }

  std::array<float, 4> pixel(const kernels::CastCamera& camera, int x, int y, int grid, const SunAndSky& light) const {
    const std::uint64_t seed = std::uint64_t(y) << 32 | std::uint64_t(x);
    const Vec3d eye = Vec3d::from(camera.eye);
    std::array<double, 4> sum{};
    for (int s = 0; s < grid * grid; ++s) {
      const double across = (s % grid + uniform(seed, 2 * std::uint64_t(s))) / grid,
                   down = (s / grid + uniform(seed, 2 * std::uint64_t(s) + 1)) / grid;
      SunAndSky from = light;
      from.seed = seed * 65537 + std::uint64_t(s) + 1;
      const std::array<float, 4> c = radiance(eye, direction_through(camera, x + across, y + down), from);
      for (std::size_t k = 0; k < 4; ++k) sum[k] += c[k];
    }
    std::array<float, 4> mean;
    for (std::size_t k = 0; k < 4; ++k) mean[k] = float(sum[k] / (grid * grid));
    return mean;
  }

  LinearPicture picture(const kernels::CastCamera& camera, int samples, const SunAndSky& light) const {
    const int grid = int(std::ceil(std::sqrt(double(samples)) - 1e-9));
    LinearPicture drawn{camera.width, camera.height, {}};
    drawn.rgba.resize(4 * drawn.pixels());
    pool.parallel_for(drawn.pixels(), 64, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto width = std::size_t(camera.width);
        const std::array<float, 4> c = pixel(camera, int(i % width), int(i / width), grid, light);
        std::copy(c.begin(), c.end(), drawn.rgba.begin() + std::ptrdiff_t(4 * i));
      }
    });
    return drawn;
  }
};

bool ReferenceCaster::is_built() { return true; }

ReferenceCaster::ReferenceCaster(const SceneSources& sources, const BakeParameters& lattice, int threads)
    : ReferenceCaster(SourceTriangles(sources, lattice, threads), threads) {}

ReferenceCaster::ReferenceCaster(SourceTriangles triangles, int threads)
    : state_(std::make_unique<State>(std::move(triangles), threads)) {}

ReferenceCaster::~ReferenceCaster() = default;

const TriangleBox& ReferenceCaster::box() const { return state_->triangles.box(); }

const SourceTriangles& ReferenceCaster::triangles() const { return state_->triangles; }

std::vector<TriangleName> ReferenceCaster::near(const Vec3d& p, double radius) const {
  std::vector<TriangleName> found;
  RTCPointQuery query{};
  const auto centre = Vec3<float>(p - state_->triangles.middle());
  query.x = centre[0], query.y = centre[1], query.z = centre[2];
  query.radius = float(radius);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto take = [](RTCPointQueryFunctionArguments* at) {
    static_cast<std::vector<TriangleName>*>(at->userPtr)->push_back({at->geomID, at->primID});
    return false;  // keeps the radius of the query
  };
  rtcPointQuery(state_->scene.get(), &query, &context, take, &found);
  std::sort(found.begin(), found.end());
  return found;
}

LinearPicture ReferenceCaster::draw(const kernels::CastCamera& camera, int samples,
                                    const kernels::CastLight& light) const {
  return state_->picture(camera, samples, {light});
}

LinearPicture ReferenceCaster::draw_shadowed(const kernels::CastCamera& camera, int samples,
                                             const kernels::CastLight& light, double sun_radius_deg) const {
  return state_->picture(camera, samples, {light, std::tan(sun_radius_deg * std::numbers::pi / 180)});
}

std::optional<double> ReferenceCaster::first_hit(const Vec3d& origin, const Vec3d& direction) const {
  double before_box = 0;
  std::optional<RTCRayHit> hit = state_->ray(origin, direction, before_box);
  if (!hit || !state_->next(*hit)) return {};
  return before_box + double(hit->ray.tfar);
}

}  // namespace gigabake::bench
