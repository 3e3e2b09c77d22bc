/// A small scene in lattice units for bake_cell(), and its result as a map from voxel to value.
///
/// One metre is one sub-voxel (voxel_size_m = 256), so that integer coordinates pass the snap unchanged.
#pragma once

#include <deque>
#include <map>

#include "bench/exact/painted.h"
#include "kernels/body/texture/id_texture_view.h"
#include "kernels/cpu/bake_cell.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake::reference {

struct BakedVoxel {
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  DirectionalCoverage directional_coverage{};  ///< zeros if the level has no such channel
  VoxelClass voxel_class = no_class;
  friend bool operator==(const BakedVoxel&, const BakedVoxel&) = default;
};
using VoxelMap = std::map<Voxel, BakedVoxel>;

/// Owned data of a PartView. The map starts as the identity.
struct Part {
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  std::vector<float> uv;
  std::vector<std::uint16_t> rgba;
  std::array<double, 12> scene_from_local{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::uint32_t material = 0;
  VoxelClass voxel_class = no_class;
  int lod = 0;
  kernels::IdTextureView id_texture = {};
  std::vector<float> id_uv = {};
};

class BakeScene {
 public:
  kernels::CellParameters parameters;

  BakeScene();

  /// Returns the index of the material. Material 0 always exists and is opaque white.
  std::uint32_t add_material(const kernels::MaterialView& material);
  std::uint32_t add_colour(const Rgba16& linear, AlphaMode mode = AlphaMode::opaque);
  /// Adds the material with a texture of sRGB bytes with straight alpha.
  std::uint32_t add_textured(kernels::MaterialView material, std::vector<std::uint8_t> rgba, int width, int height);

  /// Returns the number of a texture with these bytes in level 0.
  std::int32_t add_texture(std::vector<std::uint8_t> rgba, int width, int height);

  Part& add_part(Part part);
  /// Adds the triangle as a separate part. Coordinates are integers up to 2^52 and stay exact.
  Part& add_triangle(const Triangle& t, std::uint32_t material = 0);
  /// Adds the mesh as one part.
  /// Range   Coordinates relative to `origin` are below 2^24.
  Part& add_mesh(const std::vector<Triangle>& mesh, std::uint32_t material = 0, const LatticeVertex& origin = {});

  void set_window(const Voxel& min, std::uint32_t edge);
  Window window() const;

  /// Adds a part and a material for it.
  Part& add_painted(const Painted& painted);

  std::deque<Part>& parts() { return parts_; }
  kernels::CellVolume bake(int threads = 1) const;

 private:
  std::deque<Part> parts_;
  std::vector<kernels::MaterialView> materials_;
  std::deque<kernels::Texture> textures_;
};

/// Returns every voxel of a level, with constant nodes expanded. Positions count voxels of level `lod` on the lattice.
VoxelMap voxels_at(const kernels::CellVolume& volume, const kernels::CellParameters& parameters, int lod);

std::set<Voxel> positions_of(const VoxelMap& voxels);

/// Returns true if all arrays of the volumes are equal. Statistics are not compared.
bool same_bits(const kernels::CellVolume& a, const kernels::CellVolume& b);

const ThreadPool& policy_of(int threads);

}  // namespace gigabake::reference
