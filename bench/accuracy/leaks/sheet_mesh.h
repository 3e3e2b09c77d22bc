/// Triangles of flat pieces, as a binary glTF has them, and a scene of such triangles on disk.
///
/// Space   Lod-0 voxels, z up. Voxels are 1 m wide, so coordinates in files have the same values.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/accuracy/leaks/sheet.h"
#include "bench/bench_scene.h"
#include "sample/glb_writer.h"

namespace gigabake::bench {

/// Offset of the generated scenes that is no multiple of a voxel or of its half, quarter or eighth.
inline constexpr Vec3d off_the_lattice{13.371, -7.713, 5.237};

/// Adds a vertex without triangles.
void add_vertex(sample::GlbMesh& mesh, const Vec3d& p);
void add_sheet(sample::GlbMesh& mesh, const Sheet& sheet);
sample::GlbMesh mesh_of(const std::vector<Sheet>& sheets);

/// Returns the six sides of a box with a corner and three edges, wound outwards.
/// Range   (u, v, w) is right-handed.
std::vector<Sheet> sides_of(const Vec3d& corner, const Vec3d& u, const Vec3d& v, const Vec3d& w);

/// Replaces `folder`, writes the model to it, and returns the scene with voxels of 1 m and default settings.
/// Errors  InputError: the folder cannot be written.
BenchScene write_glb_scene(const sample::GlbModel& model, const std::filesystem::path& folder, int threads);

}  // namespace gigabake::bench
