#include "app/process/on_all_ranks.h"

#include <cstdlib>
#include <fmt/core.h>

#include "app/commands.h"
#include "app/options/flags.h"
#include "cluster/collective.h"
#include "cluster/lone_task.h"
#include "lattice/error.h"

namespace gigabake::app {

int on_all_ranks(const std::function<int(MpiSession&)>& work) {
  const Environment environment = [](const char* name) { return std::getenv(name); };
  const int tasks = tasks_of_srun(environment);
  MpiSession mpi;
  if (const auto line = lone_task(mpi.ranks(), tasks)) {
    const char* task = environment("SLURM_PROCID");
    if (task == nullptr || std::atoi(task) == 0) fmt::print(stderr, "gigabake: {}\n", *line);
    return usage;
  }
  try {
    return mpi.from_master(work(mpi));
  } catch (const CollectiveFailure& e) {
    if (*e.what() != '\0') fmt::print(stderr, "gigabake: {}\n", with_flags(e.what()));
    return failed;
  } catch (const UsageError& e) {  // the arguments are the same on every rank
    if (mpi.rank() == 0) fmt::print(stderr, "gigabake: {}\n", said(e));
    return usage;
  } catch (const RankLost& e) {
    fmt::print(stderr, "gigabake: rank {}: {}\n", mpi.rank(), e.what());
    mpi.abort(rank_lost);  // not 1, which starters take for the bake's own failure and do not launch again
  } catch (const std::exception& e) {
    if (mpi.ranks() == 1) throw;
    fmt::print(stderr, "gigabake: rank {}: {}\n", mpi.rank(), said(e));
    mpi.abort(failed);  // this rank alone failed: the others would wait for it for ever
  }
}

}  // namespace gigabake::app
