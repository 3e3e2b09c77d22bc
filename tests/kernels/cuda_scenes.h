/// Cells that use all features of a backend: colours, textures, instances, triangles of all sizes, and invalid
/// triangles.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <random>
#include <string>
#include <vector>

#include "kernels/cpu/bake_cell.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake::kernels::test {

/// Owner of the data that a CellInput borrows.
class TestCell {
 public:
  TestCell() = default;
  TestCell(TestCell&&) = default;  // a copy would borrow from the original
  TestCell& operator=(TestCell&&) = default;

  std::string name;
  std::uint32_t window_voxels = 64;
  std::vector<MaterialView> materials;

  /// Adds a part.
  /// Range   material: an index of `materials`.
  void add_part(std::vector<float> position, std::vector<std::uint32_t> index, std::uint32_t material,
                std::vector<float> uv = {}, std::vector<std::uint16_t> rgba = {});
  /// Gives all parts random vertex normals on both sides. Some vertices have none.
  void add_vertex_normals(unsigned seed);
  /// Gives all parts random normal maps of different samplers and scales. Some parts have tangents on both sides. Some
  /// vertices have no tangent or no usable coordinates.
  void add_normal_maps(unsigned seed);
  /// Adds a moved and scaled instance of the last part; a negative scale mirrors it.
  void add_instance(double x, double y, double z, double scale);
  /// Adds a texture and returns its index, for MaterialView::texture.
  std::int32_t add_texture(int width, int height, TextureAlpha alpha, unsigned seed,
                           TextureContent content = TextureContent::colours);

  CellInput input();
  /// Returns parameters in which one metre is one voxel; the window starts at the lattice's origin.
  CellParameters parameters(SurfaceRule surface, MipFilter mip, bool normals) const;

 private:
  std::deque<std::vector<float>> floats_;
  std::deque<std::vector<std::uint32_t>> indices_;
  std::deque<std::vector<std::uint16_t>> colours_;
  std::deque<std::vector<VertexNormal>> normals_;
  std::deque<std::vector<VertexTangent>> tangents_;
  std::deque<Texture> textures_;
  std::vector<PartView> parts_;
  std::vector<TextureView> views_;
};

/// Returns rolling ground of 2·quads² triangles over the window. `uv` adds texture coordinates, `rgba` adds vertex
/// colours.
TestCell ground(std::string name, std::uint32_t window_voxels, int quads, bool uv, bool rgba);
/// Returns layers of ground, with a texture for each combination of alpha mode and wrapping.
TestCell textured_ground();
/// Returns opaque ground and triangles of all sizes. Each part has either vertex colours, a texture or one colour.
TestCell opaque_ground();
/// Returns triangles from a thousandth of a voxel to a hundred thousand voxels wide, some on lattice planes.
TestCell triangle_soup(unsigned seed);
/// Returns 5,000 triangles in one voxel, and 5,000 across one brick.
TestCell crowded_voxel();
/// Returns invalid triangles: NaN and infinite vertices, no area, outside of every window, NaN texture coordinates.
TestCell bad_triangles();
/// Returns small closed boxes: mirrored and scaled instances of one mesh.
TestCell instances();
/// Returns a dense stack of planes: bricks with all 512 voxels of one colour, which become constant nodes.
TestCell constant_block();

/// Returns the cells without vertex normals and normal maps.
std::list<TestCell> flat_cells();
/// Returns cells with vertex normals: with and without textures, alpha, mirrored instances, and triangles of all sizes.
std::list<TestCell> smooth_cells();
/// Returns cells with normal maps, half of them with vertex normals.
std::list<TestCell> mapped_cells();
std::list<TestCell> all_cells();

}  // namespace gigabake::kernels::test
