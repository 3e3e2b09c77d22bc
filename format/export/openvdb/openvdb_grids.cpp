#include <cerrno>
#include <cmath>
#include <cstring>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "core/math/srgb.h"
#include "format/export/openvdb/openvdb_module.h"
#include "format/system/descriptor.h"

namespace gigabake {
namespace {

/// Approximate memory per leaf in bytes, including a part of its ancestors: in a grid of floats or integers, and in a
/// Vec3s grid.
constexpr std::uint64_t scalar_leaf_bytes = 2600, vector_leaf_bytes = 6800;

/// Sets the voxels of one leaf. value(v) returns the stored value of voxel v of the brick.
template <class Grid, class ValueOf>
void set_voxels(Grid& grid, const openvdb::Coord& lowest, const DenseBrick& part, const ValueOf& value) {
  auto* leaf = grid.tree().touchLeaf(lowest);
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel)
    if (part.has(voxel))
      leaf->setValueOn(openvdb::Index((voxel & 7) << 6 | (voxel >> 3 & 7) << 3 | voxel >> 6), value(voxel));
}

class Grids : public OpenvdbGrids {
 public:
  Grids(const SceneHeader& scene, int lod) {
    density_->setGridClass(openvdb::GRID_FOG_VOLUME);
    prepare(*density_, "density", scene, lod);
    prepare(*colour_, "Cd", scene, lod);
    if (scene.has_classes) prepare(*(class_ = openvdb::Int32Grid::create()), "class", scene, lod);
    if (!scene.has_normals) return;
    normal_ = openvdb::Vec3SGrid::create();
    normal_->setVectorType(openvdb::VEC_COVARIANT_NORMALIZE);
    prepare(*normal_, "N", scene, lod);
  }

  void add(const Vec3<std::int32_t>& corner, const DenseBrick& part) override {
    const openvdb::Coord lowest(corner[0], corner[1], corner[2]);
    const std::array<double, 256>& linear = linear_of_srgb();
    set_voxels(*density_, lowest, part, [&](std::size_t n) { return float(part.rgba[n][3]) / 255; });
    set_voxels(*colour_, lowest, part, [&](std::size_t n) {
      const auto& rgba = part.rgba[n];
      return openvdb::Vec3f(float(linear[rgba[0]]), float(linear[rgba[1]]), float(linear[rgba[2]]));
    });
    if (class_) set_voxels(*class_, lowest, part, [&](std::size_t n) { return std::int32_t(part.voxel_class[n]); });
    if (!normal_) return;
    set_voxels(*normal_, lowest, part, [&](std::size_t n) {
      const Vec3<float> v = unit_normal(part.normal[n].data());
      return openvdb::Vec3f(v[0], v[1], v[2]);
    });
  }

  std::uint64_t bytes() const override {
    return density_->tree().leafCount() *
           ((class_ ? 2 : 1) * scalar_leaf_bytes + (normal_ ? 2 : 1) * vector_leaf_bytes);
  }

  void write(const std::filesystem::path& vdb, const std::filesystem::path& temporary) const override;

 private:
  openvdb::GridPtrVec all() const {
    openvdb::GridPtrVec grids{density_, colour_};
    if (normal_) grids.push_back(normal_);
    if (class_) grids.push_back(class_);
    return grids;
  }

  static void prepare(openvdb::GridBase& grid, const char* name, const SceneHeader& scene, int lod) {
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
  openvdb::Int32Grid::Ptr class_;
};

/// Checks that one more byte fits on the disk. The library ignores failed writes. If the disk is full, this additional
/// write fails as well.
void expect_room_after(const std::filesystem::path& vdb, const std::filesystem::path& temporary) {
  const std::uintmax_t bytes = std::filesystem::file_size(temporary);
  const Descriptor file(temporary, O_WRONLY | O_APPEND);
  const std::uint8_t one_more = 0;
  if (!file.is_open() || !file.write_all({&one_more, 1}) || ::ftruncate(file.get(), off_t(bytes)) != 0)
    throw InputError(vdb, "", std::string("cannot write: ") + std::strerror(errno));
}

void Grids::write(const std::filesystem::path& vdb, const std::filesystem::path& temporary) const {
  const openvdb::GridPtrVec grids = all();
  try {
    openvdb::io::File out(temporary.string());
    out.write(grids);
    out.close();
    expect_room_after(vdb, temporary);
    openvdb::io::File in(temporary.string());
    in.setCopyMaxBytes(0);
    in.open(false);
    if (in.readGrid(grids.back()->getName())->activeVoxelCount() != grids.back()->activeVoxelCount())
      throw InputError(vdb, "", "cannot write: the file read back differs from the grids written");
  } catch (const openvdb::Exception& e) {
    throw InputError(vdb, "", std::string("cannot write: ") + e.what());
  }
}

std::unique_ptr<OpenvdbGrids> grids_of(const SceneHeader& scene, int lod) {
  openvdb::initialize();
  return std::make_unique<Grids>(scene, lod);
}

}  // namespace
}  // namespace gigabake

const gigabake::OpenvdbModule* gigabake_openvdb() {
  static const gigabake::OpenvdbModule module{gigabake::grids_of};
  return &module;
}
