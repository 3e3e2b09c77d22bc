#include "bench/bench_scene.h"

#include "format/error.h"
#include "kernels/policy.h"
#include "worker/survey_tile.h"

namespace gigabake::bench {

std::vector<CellJob> plan_cells(const SceneSources& sources, const BenchScene& scene) {
  const kernels::CpuPolicy policy(scene.threads);
  std::vector<TileSurvey> surveys;
  for (std::uint32_t t = 0; t < sources.tiles.size(); ++t)
    surveys.push_back(survey_tile(sources, t, scene.parameters, policy));
  BakePlan plan = make_plan(std::move(surveys), sources, scene.parameters);
  if (plan.jobs.empty()) throw InputError(scene.source, "", "holds no triangles to bake");
  return std::move(plan.jobs);
}

}  // namespace gigabake::bench
