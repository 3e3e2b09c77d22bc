#include "bench/query/cube_caster.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_set>

#include "bench/accuracy/embree/rtcore.h"

namespace gigabake::bench {
namespace {

struct VoxelHash {
  std::size_t operator()(const Vec3i64& v) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : v) hash = (hash ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

struct Face {
  std::uint32_t voxel;
  std::uint8_t axis, side;
};

/// Returns the faces that no neighbour covers.
std::vector<Face> open_faces(const std::vector<Vec3i64>& voxels) {
  const std::unordered_set<Vec3i64, VoxelHash> there(voxels.begin(), voxels.end());
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < voxels.size(); ++i)
    for (std::uint8_t axis = 0; axis < 3; ++axis)
      for (std::uint8_t side = 0; side < 2; ++side) {
        Vec3i64 beside = voxels[i];
        beside[axis] += side != 0 ? 1 : -1;
        if (!there.contains(beside)) faces.push_back({i, axis, side});
      }
  return faces;
}

}  // namespace

struct CubeCaster::State {
  std::vector<Vec3i64> voxels;
  std::vector<Face> faces;
  Vec3i64 middle{};
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void check(const char* call) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error(std::string(call) + ": Embree error " + std::to_string(error));
  }

  void set_middle() {
    if (voxels.empty()) return;
    Vec3i64 low = voxels.front(), high = low;
    for (const Vec3i64& v : voxels) {
      low = min_by_axis(low, v);
      high = max_by_axis(high, v);
    }
    middle = (low + high) / 2;
  }

  /// Adds the faces with integer coordinates relative to the middle, which floats represent exactly.
  void add_quads() {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertex = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 4 * faces.size()));
    auto* index = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, faces.size()));
    check("rtcSetNewGeometryBuffer");
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::uint32_t corner = 0; corner < 4; ++corner) {
        const std::size_t axis = faces[f].axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3i64 at = voxels[faces[f].voxel];
        at[axis] += faces[f].side;
        at[u] += corner == 1 || corner == 2 ? 1 : 0;
        at[v] += corner >= 2 ? 1 : 0;
        std::ranges::copy(Vec3<float>(at - middle), vertex + 12 * f + 3 * corner);
        index[4 * f + corner] = std::uint32_t(4 * f + corner);
      }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
};

CubeCaster::CubeCaster(const std::vector<Vec3i64>& voxels, int threads) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.voxels = voxels;
  s.faces = open_faces(voxels);
  s.set_middle();
  s.device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
  if (s.device == nullptr)
    throw std::runtime_error("rtcNewDevice: Embree error " + std::to_string(rtcGetDeviceError(nullptr)));
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  s.add_quads();
  rtcCommitScene(s.scene);
  s.check("rtcCommitScene");
}

CubeCaster::~CubeCaster() = default;

std::optional<CubeCaster::Hit> CubeCaster::first_hit(const Vec3d& origin, const Vec3d& direction) const {
  const State& s = *state_;
  RTCRayHit ray{};
  const auto start = Vec3<float>(origin - Vec3d(s.middle));
  ray.ray.org_x = start[0], ray.ray.org_y = start[1], ray.ray.org_z = start[2];
  ray.ray.dir_x = float(direction[0]), ray.ray.dir_y = float(direction[1]), ray.ray.dir_z = float(direction[2]);
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(s.scene, ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return Hit{s.voxels[s.faces[ray.hit.primID].voxel], double(ray.ray.tfar)};
}

}  // namespace gigabake::bench
