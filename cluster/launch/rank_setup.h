/// Configuration of a rank's bake process.
#pragma once

#include "cluster/bake/bake.h"
#include "cluster/process/bake_process.h"
#include "worker/pipeline/worker_setup.h"

namespace gigabake {

/// Returns the number of threads of this rank's bake process.
int threads_of(const MpiSession& mpi, const BakeRequest& request);
std::uint64_t memory_of(const MpiSession& mpi, const BakeRequest& request);
WorkerSetup setup_of(const MpiSession& mpi, const BakeRequest& request, const SharedSources& sources);
BakeProcessOptions process_options(const BakeRequest& request);

}  // namespace gigabake
