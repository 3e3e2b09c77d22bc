#include "scheduler/plan/merge.h"

#include <algorithm>
#include <tuple>

#include "scheduler/plan/overviews.h"

namespace gigabake {
namespace {

auto lattice_order(const SceneCell& c) { return std::make_tuple(c.lattice_min[2], c.lattice_min[1], c.lattice_min[0]); }

void add_cells(const BakePlan& plan, const std::vector<CellReport>& reports, SceneDescription& scene) {
  std::vector<const CellReport*> of_job(plan.jobs.size(), nullptr);
  for (const CellReport& r : reports)
    if (r.id < of_job.size()) of_job[r.id] = &r;
  std::vector<SceneLoss> not_baked;
  bool a_cell_is_lost = false;
  for (std::size_t i = 0; i < of_job.size(); ++i) {
    const CellJob& job = plan.jobs[i];
    const std::string name = (is_overview(job) ? "parent " : "cell ") + job.name;
    a_cell_is_lost |= !is_overview(job) && (of_job[i] == nullptr || of_job[i]->outcome == CellOutcome::failed);
    if (of_job[i] == nullptr && is_overview(job) && a_cell_is_lost) continue;  // the lost cell is already listed
    if (of_job[i] == nullptr)
      not_baked.push_back({name, "was not baked"});
    else if (of_job[i]->outcome == CellOutcome::failed)
      scene.losses.push_back({name, of_job[i]->error});
    else if (of_job[i]->outcome == CellOutcome::baked)
      (is_overview(job) ? scene.overviews : scene.cells).push_back(of_job[i]->cell);
    if (of_job[i] != nullptr && is_overview(job) && !is_made_of_all(*of_job[i], job))
      not_baked.push_back({name, "was made without cells below it that are lost"});
  }
  scene.losses.insert(scene.losses.end(), not_baked.begin(), not_baked.end());
  std::sort(scene.cells.begin(), scene.cells.end(),
            [](const SceneCell& a, const SceneCell& b) { return lattice_order(a) < lattice_order(b); });
}

}  // namespace

SceneHeader scene_header(const BakePlan& plan, const std::optional<Geodetic>& origin,
                         const BakeParameters& parameters) {
  SceneHeader scene;
  scene.generator = "gigabake " GIGABAKE_VERSION;
  scene.voxel_size_m = parameters.voxel_size_m;
  scene.lattice_origin_m = parameters.lattice_origin_m;
  scene.origin = origin;
  scene.has_normals = parameters.normals;
  scene.has_directional_coverage = has_directional_coverage(parameters);
  scene.has_classes = parameters.classes;
  scene.parameters = to_json(parameters);
  scene.leaf_lod = parameters.coarsest_lod;
  scene.bounds = plan.bounds;
  scene.triangles = plan.triangles;
  scene.non_finite = plan.non_finite;
  scene.zero_area = plan.zero_area;
  scene.skipped_points = plan.skipped_points;
  scene.skipped_lines = plan.skipped_lines;
  return scene;
}

SceneDescription merge(const BakePlan& plan, const std::vector<CellReport>& reports,
                       const std::optional<Geodetic>& origin, const BakeParameters& parameters) {
  SceneDescription scene;
  static_cast<SceneHeader&>(scene) = scene_header(plan, origin, parameters);
  scene.losses = plan.losses;
  add_cells(plan, reports, scene);
  return scene;
}

}  // namespace gigabake
