#include "bench/query/cube_caster.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_set>

#include "bench/accuracy/embree/rtcore.h"

namespace gigabake::bench {
namespace {

using Voxel = CubeCaster::Voxel;

struct VoxelHash {
  std::size_t operator()(const Voxel& v) const {
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
std::vector<Face> open_faces(const std::vector<Voxel>& voxels) {
  const std::unordered_set<Voxel, VoxelHash> there(voxels.begin(), voxels.end());
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < voxels.size(); ++i)
    for (std::uint8_t axis = 0; axis < 3; ++axis)
      for (std::uint8_t side = 0; side < 2; ++side) {
        Voxel beside = voxels[i];
        beside[axis] += side != 0 ? 1 : -1;
        if (!there.contains(beside)) faces.push_back({i, axis, side});
      }
  return faces;
}

}  // namespace

struct CubeCaster::State {
  std::vector<Voxel> voxels;
  std::vector<Face> faces;
  Voxel middle{};
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
    Voxel low, high;
    low.fill(std::numeric_limits<std::int64_t>::max());
    high.fill(std::numeric_limits<std::int64_t>::min());
    for (const Voxel& v : voxels)
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], v[a]);
        high[a] = std::max(high[a], v[a]);
      }
    for (std::size_t a = 0; a < 3 && !voxels.empty(); ++a) middle[a] = (low[a] + high[a]) / 2;
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
        Voxel at = voxels[faces[f].voxel];
        at[axis] += faces[f].side;
        at[u] += corner == 1 || corner == 2 ? 1 : 0;
        at[v] += corner >= 2 ? 1 : 0;
        for (std::size_t a = 0; a < 3; ++a) vertex[12 * f + 3 * corner + a] = float(at[a] - middle[a]);
        index[4 * f + corner] = std::uint32_t(4 * f + corner);
      }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
};

CubeCaster::CubeCaster(const std::vector<Voxel>& voxels, int threads) : state_(std::make_unique<State>()) {
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

std::optional<CubeCaster::Hit> CubeCaster::first_hit(const std::array<double, 3>& origin,
                                                     const std::array<double, 3>& direction) const {
  const State& s = *state_;
  RTCRayHit ray{};
  ray.ray.org_x = float(origin[0] - double(s.middle[0]));
  ray.ray.org_y = float(origin[1] - double(s.middle[1]));
  ray.ray.org_z = float(origin[2] - double(s.middle[2]));
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
