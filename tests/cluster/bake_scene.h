/// A small scene on disk, the setup of a bake process for it, and scripts that act as faulty bake processes.
#pragma once

#include <string>
#include <vector>

#include "cluster/process/bake_process.h"
#include "format/job/cell_job.h"
#include "tests/worker/glb_scene.h"
#include "worker/pipeline/worker_setup.h"

namespace gigabake {

/// Rolling ground, 64 m square, of four textured tiles. Cells have 128 voxels of 0.1 m per edge.
class BakeScene {
 public:
  BakeScene();

  const std::filesystem::path& folder() const { return folder_.path(); }
  std::filesystem::path source() const { return folder() / "terrain"; }
  SceneSources sources() const { return open_sources(source(), {}); }
  /// Returns the setup of a bake into FOLDER/out.
  WorkerSetup setup(const std::string& out) const;
  /// Scans the scene and returns the jobs that `gigabake bake` would plan.
  std::vector<CellJob> jobs() const;
  /// Bakes the jobs with the pipeline, in this process. Returns the pipeline's reports.
  std::vector<CellReport> baked_here(const std::vector<CellJob>& jobs, const std::string& out) const;
  /// Writes an executable shell script. A bake passes it the arguments "bake-process" and the number of its socket, 3.
  std::filesystem::path script(const std::string& name, const std::string& commands) const;

 private:
  ScratchFolder folder_;
};

/// Returns options that start the program under test. The default, /proc/self/exe, would start the test itself.
BakeProcessOptions real_program();

/// Returns the next event. Without an event within a minute, reports a failure and returns an empty Died.
BakeProcess::Event next_event(BakeProcess& process);

template <class Kind>
Kind expect(BakeProcess& process);

}  // namespace gigabake
