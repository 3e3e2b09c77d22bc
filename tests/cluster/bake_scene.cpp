#include "bake_scene.h"

#include <fstream>
#include <gtest/gtest.h>

#include "format/job/source_bytes.h"
#include "scheduler/plan/plan.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {

BakeScene::BakeScene() {
  std::filesystem::create_directories(source());
  for (int i = 0; i < 4; ++i) {
    GlbMesh mesh = rolling_ground(32, 32.0 * (i % 2), 32.0 * (i / 2));
    mesh.image = checkered_png(64);
    write_glb(source() / ("tile" + std::to_string(i) + ".glb"), mesh);
  }
}

WorkerSetup BakeScene::setup(const std::string& out) const {
  WorkerSetup setup;
  setup.sources = std::make_shared<const std::vector<std::uint8_t>>(to_bytes(sources()));
  setup.parameters.voxel_size_m = 0.1;
  setup.parameters.cell_voxels = 128;
  setup.worker = {2, 0, folder() / out, {}};
  return setup;
}

std::vector<CellJob> BakeScene::jobs() const {
  const WorkerSetup s = setup("");
  const SceneSources sources = this->sources();
  const ThreadPool pool(1);
  std::vector<TileScan> scans;
  for (std::uint32_t t = 0; t < sources.tiles.size(); ++t) scans.push_back(scan_tile(sources, t, s.parameters, pool));
  return make_plan(scans, sources, s.parameters).jobs;
}

std::vector<CellReport> BakeScene::baked_here(const std::vector<CellJob>& jobs, const std::string& out) const {
  const WorkerSetup s = setup(out);
  CellPipeline pipeline(sources(), s.parameters, s.worker);
  return bake_all(pipeline, jobs);
}

std::filesystem::path BakeScene::script(const std::string& name, const std::string& commands) const {
  const std::filesystem::path path = folder() / name;
  std::ofstream(path) << "#!/bin/sh\n" << commands << "\n";
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

BakeProcessOptions real_program() {
  BakeProcessOptions options;
  options.program = GIGABAKE_PROGRAM;
  return options;
}

BakeProcess::Event next_event(BakeProcess& process) {
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < last) {
    if (auto event = process.poll()) return *event;
    process.wait(std::chrono::milliseconds(100));
  }
  ADD_FAILURE() << "no event within a minute";
  return BakeProcess::Died{"no event", {}, {}};
}

template <class Kind>
Kind expect(BakeProcess& process) {
  const BakeProcess::Event event = next_event(process);
  if (const auto* wanted = std::get_if<Kind>(&event)) return *wanted;
  ADD_FAILURE() << "another event came: " << event.index()
                << (event.index() == 2 ? " " + std::get<BakeProcess::Died>(event).why : "");
  return {};
}

template BakeProcess::Scanned expect(BakeProcess&);
template BakeProcess::Baked expect(BakeProcess&);
template BakeProcess::Died expect(BakeProcess&);

}  // namespace gigabake
