#include "scheduler/plan/source_precision.h"

#include <algorithm>
#include <map>

namespace gigabake {
namespace {

constexpr double voxels_wanted = 0.25;

}  // namespace

SourcePrecision source_precision(const std::vector<TileScan>& scans, const SceneSources& sources, double voxel_size_m) {
  SourcePrecision out;
  out.wanted_m = voxels_wanted * voxel_size_m;
  std::map<std::string, double> coarse;
  for (const TileScan& s : scans) {
    out.max_spacing_m = std::max(out.max_spacing_m, s.spacing_m);
    if (!(s.spacing_m > out.wanted_m)) continue;
    double& spacing_m = coarse[sources.tiles[s.tile].name];
    spacing_m = std::max(spacing_m, s.spacing_m);
  }
  out.coarse_sources = coarse.size();
  for (const auto& [name, spacing_m] : coarse) out.coarse.push_back({name, spacing_m});
  std::stable_sort(out.coarse.begin(), out.coarse.end(),
                   [](const CoarseSource& a, const CoarseSource& b) { return a.spacing_m > b.spacing_m; });
  if (out.coarse.size() > SourcePrecision::max_listed) out.coarse.resize(SourcePrecision::max_listed);
  return out;
}

}  // namespace gigabake
