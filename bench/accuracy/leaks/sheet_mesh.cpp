#include "bench/accuracy/leaks/sheet_mesh.h"

#include "core/base/error.h"
#include "format/system/publish.h"

namespace gigabake::bench {

void add_vertex(sample::GlbMesh& mesh, const Vec3d& p) {
  mesh.position.insert(mesh.position.end(), {float(p[0]), float(p[2]), float(-p[1])});
}

void add_sheet(sample::GlbMesh& mesh, const Sheet& sheet) {
  const auto first = std::uint32_t(mesh.vertices());
  const Vec3d by_u = sheet.corner + sheet.u, by_v = sheet.corner + sheet.v;
  for (const Vec3d& p : {sheet.corner, by_u, by_v}) add_vertex(mesh, p);
  mesh.index.insert(mesh.index.end(), {first, first + 1, first + 2});
  if (sheet.shape == SheetShape::triangle) return;
  add_vertex(mesh, by_u + sheet.v);
  mesh.index.insert(mesh.index.end(), {first + 1, first + 3, first + 2});
}

sample::GlbMesh mesh_of(const std::vector<Sheet>& sheets) {
  sample::GlbMesh mesh;
  for (const Sheet& sheet : sheets) add_sheet(mesh, sheet);
  return mesh;
}

std::vector<Sheet> sides_of(const Vec3d& corner, const Vec3d& u, const Vec3d& v, const Vec3d& w) {
  return {{corner, v, u}, {corner, u, w}, {corner, w, v}, {corner + w, u, v}, {corner + v, w, u}, {corner + u, v, w}};
}

BenchScene write_glb_scene(const sample::GlbModel& model, const std::filesystem::path& folder, int threads) {
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder, "", "cannot make the folder: " + error.message());
  BenchScene bench;
  bench.source = folder / "scene.glb";
  bench.source_options.local = true;
  bench.parameters.voxel_size_m = 1;
  bench.threads = threads;
  const std::vector<std::uint8_t> glb = sample::to_glb(model);
  publish_file(bench.source, {reinterpret_cast<const char*>(glb.data()), glb.size()}, Durability::while_up);
  return bench;
}

}  // namespace gigabake::bench
