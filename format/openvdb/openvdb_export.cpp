#include "format/openvdb/openvdb_export.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include "format/descriptor.h"
#include "format/error.h"
#include "format/octahedral.h"
#include "format/publish.h"
#include "format/scene_level.h"
#include "format/srgb.h"

namespace gigabake {
namespace {

/// Bytes of a leaf with its part of the nodes above, in a grid of floats and of three floats.
constexpr std::uint64_t scalar_leaf_bytes = 2600, vector_leaf_bytes = 6800;

openvdb::Coord coord_of(const std::filesystem::path& scene_xml, const LevelIndex& index) {
  for (const std::int64_t i : index)
    if (i != std::int32_t(i))
      throw InputError(scene_xml, "LatticeMin", "OpenVDB has no room for indices beyond 32 bits");
  return {std::int32_t(index[0]), std::int32_t(index[1]), std::int32_t(index[2])};
}

/// `value` says what of voxel n is stored.
template <class Grid, class ValueOf>
void set_voxels(Grid& grid, const openvdb::Coord& lowest, const DenseBrick& part, const ValueOf& value) {
  auto* leaf = grid.tree().touchLeaf(lowest);
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel)
    if (part.has(voxel))
      leaf->setValueOn(openvdb::Index((voxel & 7) << 6 | (voxel >> 3 & 7) << 3 | voxel >> 6), value(voxel));
}

class OpenvdbGrids {
 public:
  explicit OpenvdbGrids(const SceneDescription& scene, int lod) {
    density_->setGridClass(openvdb::GRID_FOG_VOLUME);
    prepare(*density_, "density", scene, lod);
    prepare(*colour_, "Cd", scene, lod);
    if (!scene.has_normals) return;
    normal_ = openvdb::Vec3SGrid::create();
    normal_->setVectorType(openvdb::VEC_COVARIANT_NORMALIZE);
    prepare(*normal_, "N", scene, lod);
  }

  void add(const openvdb::Coord& lowest, const DenseBrick& part) {
    const std::array<double, 256>& linear = linear_of_srgb();
    set_voxels(*density_, lowest, part, [&](std::size_t n) { return float(part.rgba[n][3]) / 255; });
    set_voxels(*colour_, lowest, part, [&](std::size_t n) {
      const auto& rgba = part.rgba[n];
      return openvdb::Vec3f(float(linear[rgba[0]]), float(linear[rgba[1]]), float(linear[rgba[2]]));
    });
    if (!normal_) return;
    set_voxels(*normal_, lowest, part, [&](std::size_t n) {
      const std::array<float, 3> v = unit_normal(part.normal[n].data());
      return openvdb::Vec3f(v[0], v[1], v[2]);
    });
  }

  std::uint64_t bytes() const {
    return density_->tree().leafCount() * (scalar_leaf_bytes + (normal_ ? 2 : 1) * vector_leaf_bytes);
  }

  openvdb::GridPtrVec all() const {
    openvdb::GridPtrVec grids{density_, colour_};
    if (normal_) grids.push_back(normal_);
    return grids;
  }

 private:
  static void prepare(openvdb::GridBase& grid, const char* name, const SceneDescription& scene, int lod) {
    const double voxel_m = std::ldexp(scene.voxel_size_m, lod);
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel_m);
    const auto& origin = scene.lattice_origin_m;
    transform->postTranslate({origin[0] + voxel_m / 2, origin[1] + voxel_m / 2, origin[2] + voxel_m / 2});
    grid.setTransform(transform);
    grid.setName(name);
    grid.setCreator(scene.generator);
    if (!scene.origin) return;
    grid.insertMeta("latitude_deg", openvdb::DoubleMetadata(scene.origin->latitude_deg));
    grid.insertMeta("longitude_deg", openvdb::DoubleMetadata(scene.origin->longitude_deg));
    grid.insertMeta("height_m", openvdb::DoubleMetadata(scene.origin->height_m));
  }

  openvdb::FloatGrid::Ptr density_ = openvdb::FloatGrid::create();
  openvdb::Vec3SGrid::Ptr colour_ = openvdb::Vec3SGrid::create(), normal_;
};

/// The library does not look whether its bytes arrived. Where the disk is full it has no room for one more either.
void expect_room_after(const std::filesystem::path& vdb, const std::filesystem::path& aside) {
  const std::uintmax_t bytes = std::filesystem::file_size(aside);
  const Descriptor file(aside, O_WRONLY | O_APPEND);
  const std::uint8_t one_more = 0;
  if (!file.is_open() || !file.write_all({&one_more, 1}) || ::ftruncate(file.get(), off_t(bytes)) != 0)
    throw InputError(vdb, "", std::string("cannot write: ") + std::strerror(errno));
}

void write(const std::filesystem::path& vdb, const std::filesystem::path& aside, const openvdb::GridPtrVec& grids) {
  try {
    openvdb::io::File out(aside.string());
    out.write(grids);
    out.close();
    expect_room_after(vdb, aside);
    openvdb::io::File in(aside.string());
    in.setCopyMaxBytes(0);
    in.open(false);
    if (in.readGrid(grids.back()->getName())->activeVoxelCount() != grids.back()->activeVoxelCount())
      throw InputError(vdb, "", "cannot write: what was written is not what is read back");
  } catch (const openvdb::Exception& e) {
    throw InputError(vdb, "", std::string("cannot write: ") + e.what());
  }
}

}  // namespace

std::uint64_t openvdb_memory_bytes() {
  return std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE)) / 2;
}

std::uint64_t export_openvdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& vdb,
                             std::uint64_t most_bytes) {
  const SceneDescription scene = read_scene(scene_xml);
  const std::uint64_t voxels = voxels_of_level(scene_xml, scene, lod);
  openvdb::initialize();
  Publication publication(vdb);
  OpenvdbGrids grids(scene, lod);
  std::uint64_t parts = 0;
  for_each_block_part(scene_xml, scene, lod, [&](const LevelIndex& lowest, const DenseBrick& part) {
    grids.add(coord_of(scene_xml, lowest), part);
    if (++parts % 256 == 0 && grids.bytes() > most_bytes)
      throw InputError(scene_xml, "",
                       fmt::format("its grids take more than {} MiB of memory; a coarser --lod or --to nvdb takes less",
                                   most_bytes >> 20));
  });
  write(vdb, publication.aside(), grids.all());
  publication.publish();
  return voxels;
}

}  // namespace gigabake
