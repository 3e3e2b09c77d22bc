#include "format/export/ply/ply.h"

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "format/scene/scene_level.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/levels/brick_walk.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

/// Bytes of a vertex without its class, and with it.
constexpr std::size_t plain_vertex_bytes = 3 * 8 + 3 * 4 + 4 + 3 * 4,
                      max_vertex_bytes = plain_vertex_bytes + sizeof(VoxelClass);

/// Returns the comments that place the scene's frame on the earth; empty for a local scene.
std::string origin_comments(const SceneHeader& scene) {
  if (!scene.origin) return {};
  return fmt::format(
      "comment frame east north up, metres, WGS84\ncomment origin_latitude_deg {}\ncomment origin_longitude_deg {}\n"
      "comment origin_height_m {}\n",
      scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m);
}

std::string header(const SceneHeader& scene, int lod, std::uint64_t voxels) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}, lod {}, voxels of {} m\n{}element vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nproperty int i\nproperty int j\nproperty int k\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
      "property float nx\nproperty float ny\nproperty float nz\n{}end_header\n",
      scene.generator, lod, std::ldexp(scene.voxel_size_m, lod), origin_comments(scene), voxels,
      scene.has_classes ? "property ushort class\n" : "");
}

/// Writer of the vertices, shard by shard.
class VertexStream {
 public:
  VertexStream(const SceneHeader& scene, int lod, const std::filesystem::path& target,
               const std::filesystem::path& temporary, const Progress& progress)
      : scene_(scene),
        lod_(lod),
        target_(target),
        progress_(progress),
        vertex_bytes_(scene.has_classes ? max_vertex_bytes : plain_vertex_bytes),
        out_(temporary, std::ios::binary) {}

  void write(std::string_view bytes) {
    errno = 0;
    if (!out_.write(bytes.data(), std::streamsize(bytes.size())))
      throw InputError(target_, "", std::string("cannot write: ") + std::strerror(errno));
  }

  void write_shard(const std::filesystem::path& shard, const ReadLevel& read) {
    const Vec3i64& low = read.header.lattice_min;
    for_each_voxel_of_level(read.nodes, read.level, lod_ - int(read.header.first_lod),
                            [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                                const std::int8_t* normal, const std::uint8_t*, VoxelClass voxel_class) {
                              add_vertex(shard, low + (Vec3i64{x, y, z} << lod_), rgba, normal, voxel_class);
                            });
  }

  void finish() {
    flush();
    out_.close();
    if (!out_) throw InputError(target_, "", std::string("cannot write: ") + std::strerror(errno));
  }

 private:
  void add_vertex(const std::filesystem::path& shard, const Vec3i64& corner, const std::uint8_t* rgba,
                  const std::int8_t* normal, VoxelClass voxel_class) {
    if (used_ + vertex_bytes_ > buffer_.size()) flush();
    char* const to = buffer_.data() + used_;
    const Vec3d half = Vec3d::all(std::ldexp(0.5, lod_));
    const Vec3d centre_m = scene_.lattice_origin_m + (Vec3d(corner) + half) * scene_.voxel_size_m;
    const Vec3i64 index = corner >> lod_;
    const Vec3<std::int32_t> index32(index);
    if (index != Vec3i64(index32))
      throw InputError(shard, "lattice_min", "a PLY cannot store indices of more than 32 bits");
    const Vec3<float> n = scene_.has_normals ? unit_normal(normal) : Vec3<float>{};
    std::memcpy(to, &centre_m, 24);
    std::memcpy(to + 24, &index32, 12);
    std::memcpy(to + 36, rgba, 4);
    std::memcpy(to + 40, &n, 12);
    if (scene_.has_classes) std::memcpy(to + plain_vertex_bytes, &voxel_class, sizeof voxel_class);
    used_ += vertex_bytes_;
  }
  void flush() {
    write({buffer_.data(), used_});
    progress_.advance(used_ / vertex_bytes_);
    used_ = 0;
  }

  const SceneHeader& scene_;
  int lod_;
  const std::filesystem::path& target_;
  const Progress& progress_;
  std::size_t vertex_bytes_;
  std::ofstream out_;
  std::array<char, max_vertex_bytes * 4096> buffer_;
  std::size_t used_ = 0;
};

}  // namespace

std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply,
                         const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  Publication publication(ply, Leftovers::remove);
  progress.step("writing the voxels", voxels);
  VertexStream stream(scene.header(), lod, ply, publication.temporary(), progress);
  stream.write(header(scene.header(), lod, voxels));
  for_each_shard_of_level(scene, lod, [&paged = scene, &stream, lod](const SceneCell& shard) {
    stream.write_shard(paged.folder() / shard.file, read_level(paged, shard, lod));
  });
  stream.finish();
  publication.publish();
  return voxels;
}

}  // namespace gigabake
