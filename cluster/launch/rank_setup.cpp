#include "cluster/launch/rank_setup.h"

#include "cluster/bake/bake_scratch.h"
#include "format/system/host_limits.h"

namespace gigabake {

int threads_of(const MpiSession& mpi, const BakeRequest& request) {
  return request.threads > 0 ? request.threads : mpi.cores();
}

BakeProcessOptions process_options(const BakeRequest& request) {
  BakeProcessOptions options;
  options.timeouts = request.timeouts;
  return options;
}

std::uint64_t memory_of(const MpiSession& mpi, const BakeRequest& request) {
  if (!request.is_default_memory) return request.memory_bytes;
  return default_memory(request.memory_bytes, host_limits().memory_bytes, mpi.ranks_on_host());
}

WorkerSetup setup_of(const MpiSession& mpi, const BakeRequest& request, const SharedSources& sources) {
  WorkerSetup setup;
  setup.parameters = request.parameters;
  setup.worker = {threads_of(mpi, request), memory_of(mpi, request),   request.out,        {},
                  request.threads == 0,     request.is_default_memory, scratch_of(request)};
  setup.device = {request.backend, request.gpus, mpi.rank_on_host(), mpi.ranks_on_host(), request.edits.has_value()};
  setup.sources = sources.bytes;
  return setup;
}

}  // namespace gigabake
