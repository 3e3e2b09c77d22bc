#include "format/export/las/las.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "format/export/las/las_header.h"
#include "format/scene/scene_level.h"
#include "format/shard/levels/brick_walk.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

constexpr std::size_t points_per_batch = 4096;
constexpr VoxelClass max_las_class = 255;

struct Voxel {
  Vec3i64 corner;  ///< lod-0 voxels
  std::uint8_t rgba[4];
  std::int8_t normal[2];
  VoxelClass voxel_class;
};

LasHeader header_of(const SceneHeader& scene, const LasFrame& frame) {
  LasHeader header{scene.generator, frame.wkt, scene.has_normals, scene.has_classes, frame.scale, frame.offset};
  if (frame.from_scene_m) return header;
  header.scale.fill(scene.voxel_size_m / 2);
  std::copy(scene.lattice_origin_m.begin(), scene.lattice_origin_m.end(), header.offset.begin());
  return header;
}

/// Writer of the points, shard by shard.
class PointStream {
 public:
  PointStream(const SceneHeader& scene, int lod, const LasFrame& frame, const std::filesystem::path& target,
              const std::filesystem::path& temporary, const Progress& progress)
      : scene_(scene),
        lod_(lod),
        frame_(frame),
        header_(header_of(scene, frame)),
        target_(target),
        progress_(progress),
        out_(temporary, std::ios::binary) {
    write(las_header(header_, 0, {}));
  }

  void write_shard(const ReadLevel& read) {
    const Vec3i64& low = read.header.lattice_min;
    for_each_voxel_of_level(read.nodes, read.level, lod_ - int(read.header.first_lod),
                            [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                                const std::int8_t* normal, const std::uint8_t*, VoxelClass voxel_class) {
                              Voxel& voxel = batch_.emplace_back();
                              voxel.corner = low + (Vec3i64{x, y, z} << lod_);
                              std::copy_n(rgba, 4, voxel.rgba);
                              voxel.voxel_class = voxel_class;
                              if (scene_.has_normals) std::copy_n(normal, 2, voxel.normal);
                              if (batch_.size() == points_per_batch) flush();
                            });
  }

  /// Writes the header again, with the number and the bounds of the points.
  void finish() {
    flush();
    out_.seekp(0);
    write(las_header(header_, points_, bounds_));
    out_.close();
    if (!out_) fail();
  }

 private:
  using Integers = std::array<std::int32_t, 3>;

  void write(const std::vector<std::uint8_t>& bytes) {
    errno = 0;
    if (!out_.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()))) fail();
  }

  [[noreturn]] void fail() const {
    throw InputError(target_, "", std::string("cannot write: ") + std::strerror(errno));
  }

  void flush() {
    bytes_.clear();
    const std::vector<Integers> integers = frame_.from_scene_m ? rounded_integers() : exact_integers();
    for (std::size_t i = 0; i < batch_.size(); ++i) put_point(batch_[i], integers[i]);
    write(bytes_);
    progress_.advance(batch_.size());
    points_ += batch_.size();
    batch_.clear();
  }

  std::int32_t as_integer(double value) const {
    if (!(std::fabs(value) <= 2147483647.0))
      throw InputError(target_, "crs", "a point has no coordinates in this system, or they exceed the 32 bits of LAS");
    return std::int32_t(std::lround(value));
  }

  /// Returns the centres of the voxels in half voxels of lod 0.
  std::vector<Integers> exact_integers() const {
    std::vector<Integers> out(batch_.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        out[i][c] = as_integer(double(2 * batch_[i].corner[c] + (std::int64_t(1) << lod_)));
    return out;
  }

  std::vector<Integers> rounded_integers() const {
    std::vector<std::array<double, 3>> points(batch_.size());
    const Vec3d half = Vec3d::all(std::ldexp(0.5, lod_));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d centre_m = scene_.lattice_origin_m + (Vec3d(batch_[i].corner) + half) * scene_.voxel_size_m;
      std::copy(centre_m.begin(), centre_m.end(), points[i].begin());
    }
    frame_.from_scene_m(points);
    std::vector<Integers> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) out[i][c] = as_integer((points[i][c] - header_.offset[c]) / header_.scale[c]);
    return out;
  }

  template <class T>
  void put(const T& value) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof(T));
  }

  void put_point(const Voxel& voxel, const Integers& integers) {
    for (std::size_t c = 0; c < 3; ++c) {
      put(integers[c]);
      bounds_.low[c] = std::min(bounds_.low[c], integers[c]);
      bounds_.high[c] = std::max(bounds_.high[c], integers[c]);
    }
    put(std::uint16_t(0));    // intensity: none
    put(std::uint8_t(0x11));  // the first of one return
    put(std::uint8_t(0));     // flags
    put(std::uint8_t(voxel.voxel_class <= max_las_class ? voxel.voxel_class : no_class));
    for (int i = 0; i < 5; ++i) put(std::uint8_t(0));  // user data, scan angle, point source
    put(0.0);                                          // GPS time
    for (std::size_t c = 0; c < 3; ++c) put(std::uint16_t(voxel.rgba[c] * 257));
    put(voxel.rgba[3]);
    if (scene_.has_normals) put(unit_normal(voxel.normal));
    if (scene_.has_classes) put(voxel.voxel_class);
  }

  const SceneHeader& scene_;
  int lod_;
  const LasFrame& frame_;
  LasHeader header_;
  const std::filesystem::path& target_;
  const Progress& progress_;
  std::ofstream out_;
  std::vector<Voxel> batch_;
  std::vector<std::uint8_t> bytes_;
  std::uint64_t points_ = 0;
  LasBounds bounds_;
};

}  // namespace

std::uint64_t export_las(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& las,
                         const LasFrame& frame, const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  Publication publication(las, Leftovers::remove);
  progress.step("writing the points", voxels);
  PointStream stream(scene.header(), lod, frame, las, publication.temporary(), progress);
  for_each_shard_of_level(scene, lod, [&paged = scene, &stream, lod](const SceneCell& shard) {
    stream.write_shard(read_level(paged, shard, lod));
  });
  stream.finish();
  publication.publish();
  return voxels;
}

}  // namespace gigabake
