#include "app/process/on_all_ranks.h"

#include <cstdlib>

#include "app/commands.h"
#include "app/options/flags.h"
#include "app/process/missing_report.h"
#include "app/process/standard_streams.h"
#include "cluster/launch/build_identity.h"
#include "cluster/launch/launcher.h"
#include "cluster/mpi/collective.h"
#include "cluster/mpi/mpi_version.h"
#include "core/base/error.h"
#include "format/system/message.h"

namespace gigabake::app {

int on_all_ranks(const std::string& command, const std::function<int(MpiSession&)>& work) {
  if (const auto line = has_mpi() ? std::nullopt : ranks_without_mpi_error(environment_of_process)) {
    // mpirun ends all processes when the first one fails: only the process that prints the line fails.
    if (rank_from_launcher(environment_of_process) != 0) return complete;
    print_message("gigabake: {}\n", *line);
    return usage;
  }
  const int tasks = slurm_task_count(environment_of_process);
  MpiSession mpi;
  if (const auto line = unlaunched_rank_error(mpi.ranks(), tasks)) {
    const char* task = environment_of_process("SLURM_PROCID");
    if (task == nullptr || std::atoi(task) == 0) print_message("gigabake: {}\n", *line);
    return usage;
  }
  if (mpi.rank() != 0) silence_missing_data();
  try {
    expect_same_build(mpi, command);
    return mpi.from_master(work(mpi));
  } catch (const CollectiveUsageError& e) {
    if (*e.what() != '\0') print_message("gigabake: {}\n", with_flags(e.what()));
    return usage;
  } catch (const CollectiveFailure& e) {
    if (*e.what() != '\0') print_message("gigabake: {}\n", with_flags(e.what()));
    return failed;
  } catch (const UsageError& e) {  // the arguments are the same on every rank
    if (mpi.rank() == 0) print_message("gigabake: {}\n", error_text(e));
    return usage;
  } catch (const RankLost& e) {
    print_message("gigabake: rank {}: {}\n", mpi.rank(), e.what());
    mpi.abort(rank_lost);  // not 1: launch scripts take 1 for a failure of the bake and do not restart it
  } catch (const std::exception& e) {
    if (mpi.ranks() == 1) throw;
    if (mpi.rank() == 0 && has_output_failed()) return mpi.from_master(failed);  // the other ranks wait in this call
    print_message("gigabake: rank {}: {}\n", mpi.rank(), error_text(e));
    mpi.abort(failed);  // only this rank failed: the other ranks would wait for it forever
  }
}

}  // namespace gigabake::app
