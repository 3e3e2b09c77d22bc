#include "app/options/polygon_file.h"

#include "core/base/error.h"
#include "format/system/host_limits.h"
#include "worker/scan/source_triangles.h"

namespace gigabake::app {

std::shared_ptr<const PolygonMesh> read_polygons(const std::filesystem::path& file, int threads) {
  SourceOptions options;
  options.local = true;
  const SceneSources sources = open_sources(file, options);
  if (!sources.skipped.empty()) throw InputError(file, sources.skipped.front().name, sources.skipped.front().reason);
  BakeParameters metres;  // a lattice whose unit is one metre and whose origin is the scene's origin
  metres.voxel_size_m = 1;
  const auto source =
      std::make_shared<const SourceTriangles>(sources, metres, threads > 0 ? threads : host_limits().cores());
  auto mesh = std::make_shared<PolygonMesh>();
  std::vector<TriangleName> names;
  for (std::size_t part = 0; part < source->parts(); ++part)
    for (std::size_t t = 0; t < source->indices(part).size / 3; ++t) {
      const auto corners = source->corners(part, t);
      std::array<Point<Scene>, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = {corners[k][0], corners[k][1], corners[k][2]};
      mesh->triangles.push_back(triangle);
      names.push_back({std::uint32_t(part), std::uint32_t(t)});
    }
  mesh->colour = [source, names = std::move(names)](std::size_t triangle, float second, float third) {
    return source->colour({names[triangle].part, names[triangle].triangle, second, third});
  };
  return mesh;
}

}  // namespace gigabake::app
