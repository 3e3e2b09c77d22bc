// Bakes one window of a source, exports the finest level of a scene, and renders the scene.
// Prints three numbers: voxels of the window, voxels of the export, pixels of the scene.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <format/export/ply/ply.h>
#include <format/source/source.h>
#include <kernels/cpu/bake_cell.h>
#include <vector>
#include <viewer/pictures/frame_renderer.h>
#include <viewer/pictures/image_files.h>

namespace {

using namespace gigabake;

/// Bakes the scene within 64 m of the origin without textures. Returns the number of voxels.
std::uint64_t baked_voxels(const char* source) {
  const SceneSources sources = open_sources(source, {});
  std::vector<TileMesh> meshes;
  for (const TileRef& tile : sources.tiles) meshes.push_back(read_tile(tile, sources.root, ReadScope::everything));
  std::vector<kernels::PartView> parts;
  for (const TileMesh& mesh : meshes)
    for (const Instance& instance : mesh.instances) {
      const Primitive& primitive = mesh.primitives[std::size_t(instance.primitive)];
      kernels::PartView part;
      part.position = {primitive.position.data(), primitive.position.size()};
      part.index = {primitive.index.data(), primitive.index.size()};
      for (int k = 0; k < 12; ++k) part.scene_from_local[k] = instance.scene_from_local.m[k / 4][k % 4];
      parts.push_back(part);
    }
  const kernels::MaterialView white;
  kernels::CellInput input;
  input.parts = {parts.data(), parts.size()};
  input.materials = {&white, 1};
  kernels::CellParameters parameters;
  parameters.frame.voxel_size_m = 0.5;
  for (std::int64_t& corner : parameters.window_min) corner = -128;
  parameters.window_voxels = 256;
  const kernels::CellVolume volume = bake_cell(input, parameters, ThreadPool(2));
  return volume.levels.empty() ? 0 : volume.levels.front().rgba.size() / 4;
}

std::uint64_t drawn_pixels(const char* scene, const char* png) {
  FrameRenderer renderer(scene, {});
  View view;
  view.camera.width = view.camera.height = 64;
  view.background = {false, {0, 0, 0, 0}};
  const Picture picture = renderer.render_complete(view).picture;
  write_png(png, picture);
  std::uint64_t pixels = 0;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) pixels += picture.rgba[i] > 0 ? 1 : 0;
  return pixels;
}

}  // namespace

int main(int arguments, char** argument) {
  if (arguments != 5) return 2;
  try {
    const std::uint64_t baked = baked_voxels(argument[1]);
    const std::uint64_t exported = export_ply(argument[2], 0, argument[3]);
    const std::uint64_t drawn = drawn_pixels(argument[2], argument[4]);
    std::printf("%llu %llu %llu\n", static_cast<unsigned long long>(baked), static_cast<unsigned long long>(exported),
                static_cast<unsigned long long>(drawn));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
