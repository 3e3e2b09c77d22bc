#include "format/ply.h"

#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <limits>

#include "format/brick_walk.h"
#include "format/error.h"
#include "format/publish.h"
#include "format/scene_xml.h"

namespace gigabake {
namespace {

constexpr std::size_t vertex_bytes = 3 * 8 + 3 * 4 + 4 + 3 * 4;

/// Source  Cigolle et al. 2014, octahedral unit vectors.
void unit_normal(const std::int8_t oct[2], float n[3]) {
  double x = oct[0] / 127.0, y = oct[1] / 127.0;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  n[0] = float(x / length);
  n[1] = float(y / length);
  n[2] = float(z / length);
}

std::string header(std::uint64_t voxels) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nproperty int i\nproperty int j\nproperty int k\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
      "property float nx\nproperty float ny\nproperty float nz\nend_header\n",
      voxels);
}

class PlyWriter {
 public:
  PlyWriter(const SceneDescription& scene, int lod, std::ostream& out) : scene_(scene), lod_(lod), out_(out) {}

  void write_cell(const std::filesystem::path& path) {
    const ShardHeader head = read_shard_header(path);
    const NodeTable nodes = read_shard_nodes(path);
    const BrickLevel level = read_shard_level(path, lod_);
    const auto visit = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                           const std::int8_t* normal) {
      write_voxel(path,
                  {head.lattice_min[0] + (std::int64_t(x) << lod_), head.lattice_min[1] + (std::int64_t(y) << lod_),
                   head.lattice_min[2] + (std::int64_t(z) << lod_)},
                  rgba, normal);
    };
    for (std::size_t n = 0; n < nodes.key.size(); ++n) {
      const bool here = nodes.lod[n] == lod_;
      if (here && nodes.kind[n] == NodeKind::brick) {
        if (nodes.value[n] >= level.mask.size() / 8)
          throw InputError(path, "/nodes/value", "names a brick that is not there");
        for_each_voxel(level, nodes.value[n], brick_position(nodes.key[n]), visit);
      } else if ((here && nodes.kind[n] == NodeKind::constant) ||
                 (nodes.lod[n] >= lod_ && nodes.kind[n] == NodeKind::leaf_constant)) {
        for_each_constant_voxel(nodes, n, nodes.lod[n] - lod_, visit);
      }
    }
  }
  std::uint64_t written() const { return written_; }

 private:
  void write_voxel(const std::filesystem::path& path, const std::array<std::int64_t, 3>& corner,
                   const std::uint8_t* rgba, const std::int8_t* normal) {
    char bytes[vertex_bytes];
    const double half = double(std::int64_t(1) << lod_) / 2;
    for (std::size_t c = 0; c < 3; ++c) {
      const double centre_m = scene_.lattice_origin_m[c] + (double(corner[c]) + half) * scene_.voxel_size_m;
      std::memcpy(bytes + 8 * c, &centre_m, 8);
      const std::int64_t index = corner[c] >> lod_;
      if (index != std::int32_t(index))
        throw InputError(path, "lattice_min", "lattice indices beyond 32 bits do not fit a PLY");
      const auto index32 = std::int32_t(index);
      std::memcpy(bytes + 24 + 4 * c, &index32, 4);
    }
    std::memcpy(bytes + 36, rgba, 4);
    float n[3] = {0, 0, 0};
    if (scene_.has_normals) unit_normal(normal, n);
    std::memcpy(bytes + 40, n, 12);
    out_.write(bytes, vertex_bytes);
    ++written_;
  }

  const SceneDescription& scene_;
  int lod_;
  std::ostream& out_;
  std::uint64_t written_ = 0;
};

std::uint64_t voxels_on(const SceneDescription& scene, int lod) {
  std::uint64_t voxels = 0;
  for (const SceneCell& c : scene.cells)
    if (std::uint32_t(lod) < c.lods) voxels += c.voxels[std::size_t(lod)];
  return voxels;
}

}  // namespace

std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply) {
  const SceneDescription scene = read_scene(scene_xml);
  Publication publication(ply);
  std::ofstream out(publication.aside(), std::ios::binary);
  const std::uint64_t expected = voxels_on(scene, lod);
  out << header(expected);
  PlyWriter writer(scene, lod, out);
  for (const SceneCell& c : scene.cells)
    if (std::uint32_t(lod) < c.lods) writer.write_cell(scene_xml.parent_path() / c.file);
  if (writer.written() != expected)
    throw InputError(scene_xml, "Voxels", "scene.xml counts other voxels than the shards hold");
  if (!out.flush()) throw InputError(ply, "", "cannot be written (disk full?)");
  out.close();
  publication.publish();
  return expected;
}

}  // namespace gigabake
