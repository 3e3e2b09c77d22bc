#include "app/options/map_crs.h"

#include "core/base/error.h"
#include "format/source/raster/crs_map.h"

namespace gigabake::app {

MapFrame open_map_frame(const SceneHeader& scene, const std::string& crs, int threads) {
  const std::string name = crs.empty() ? default_map_crs(scene) : crs;
  if (name == "scene") return MapFrame(scene);
  try {
    return {scene, [&] { return open_crs_map(name); }, threads};
  } catch (const InputError& e) {
    throw UsageError(std::string("--crs: ") + e.what());
  }
}

AreaOptions area_without_map_crs(const AreaOptions& options) {
  AreaOptions area = options;
  if (area.bounds.empty()) area.crs.clear();
  return area;
}

}  // namespace gigabake::app
