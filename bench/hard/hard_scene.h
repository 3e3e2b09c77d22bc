/// A hard scene and the content of its files: tiles whose nodes place meshes. The z axis points up.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/exact/painted.h"
#include "core/math/frames.h"
#include "core/octree/octree.h"
#include "format/source/mesh.h"

namespace gigabake::bench {

struct HardMesh {
  std::vector<float> position;       ///< 3 per vertex
  std::vector<std::uint32_t> index;  ///< 3 per triangle
  std::vector<float> uv;             ///< 2 per vertex, or empty
  std::vector<std::uint16_t> rgba;   ///< 4 per vertex, linear, or empty
  int material = 0;
};

struct HardNode {
  int mesh = 0;
  Affine<Local, Local> map;  ///< the node's matrix
};

struct HardMaterial {
  reference::Rgba16 base = reference::white16;
  AlphaMode mode = AlphaMode::opaque;
  int image = -1;
};

struct HardTile {
  std::vector<HardMesh> meshes;
  std::vector<HardNode> nodes;
  std::vector<HardMaterial> materials{HardMaterial()};
  std::vector<Image> images;       ///< PNG in the file
  Affine<World, World> transform;  ///< of the tile, in tileset.json
  int lod = 0;                     ///< level of its voxels; above 0 they are leaves
  VoxelClass voxel_class = no_class;
};

/// A 3D Tiles tileset. If the scene is on the earth, transforms lead to ECEF.
struct HardScene {
  std::vector<HardTile> tiles;
  bool on_earth = false;
  std::optional<Geodetic> origin;  ///< --origin; nullopt: the source's own
};

/// Adds a mesh with one triangle, and its node. Coordinates are in units of `unit_m` metres, a power of two. Integers
/// up to 2^52 are stored exactly.
void add_triangle(HardTile& tile, const reference::Triangle& t, double unit_m, int material = 0);
/// Adds all triangles as one mesh.
/// Range   Coordinates are below 2^24 units.
void add_mesh(HardTile& tile, const std::vector<reference::Triangle>& mesh, double unit_m, int material = 0);
/// Adds a mesh with its own material.
void add_painted(HardTile& tile, const reference::Painted& painted, double unit_m);

Affine<Local, Local> scaled(double x, double y, double z);

/// Writes tileset.json and one GLB per tile. Indices use one byte if possible. Returns the tileset's path.
/// Errors  InputError: the folder cannot be written.
std::filesystem::path write_scene(const std::filesystem::path& folder, const HardScene& scene);

}  // namespace gigabake::bench
