#include "cluster/launch/launcher.h"

#include <algorithm>
#include <cstdlib>

namespace gigabake {
namespace {

bool may_have_other_ranks(const Environment& environment) {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* size = environment(name)) return std::atoi(size) != 1;
  if (environment("SLURM_STEP_ID") != nullptr) return slurm_task_count(environment) > 1;
  return slurm_task_count(environment) > 1 || is_launched(environment);
}

}  // namespace

int slurm_task_count(const Environment& environment) {
  const auto number = [&](const char* name) {
    const char* text = environment(name);
    return text == nullptr ? 1 : std::max(1, std::atoi(text));
  };
  if (environment("OMPI_COMM_WORLD_SIZE") != nullptr) return 1;  // mpirun may start a single rank
  if (environment("SLURM_STEP_NUM_TASKS") != nullptr) return number("SLURM_STEP_NUM_TASKS");
  const bool is_batch_script = environment("SLURM_JOB_ID") != nullptr && environment("SLURM_STEP_ID") == nullptr;
  return is_batch_script ? 1 : number("SLURM_NTASKS");
}

bool is_launched(const Environment& environment) {
  // In order: mpirun; PMIx, used by mpirun, prterun and srun; PMI-1 and PMI-2; a Slurm step without any of these; PALS.
  constexpr const char* of_launchers[] = {
      "OMPI_COMM_WORLD_SIZE", "PMIX_RANK",  "PMIX_NAMESPACE", "PMI_RANK", "PMI_FD", "PMI_PORT",
      "SLURM_STEP_ID",        "PALS_RANKID"};
  return std::ranges::any_of(of_launchers, [&](const char* name) { return environment(name) != nullptr; });
}

int rank_from_launcher(const Environment& environment) {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "PALS_RANKID", "SLURM_PROCID"})
    if (const char* rank = environment(name)) return std::atoi(rank);
  return 0;
}

std::optional<LocalRank> local_rank_from_launcher(const Environment& environment) {
  if (!is_launched(environment)) return LocalRank{};
  const char* rank = environment("OMPI_COMM_WORLD_LOCAL_RANK");
  const char* ranks = environment("OMPI_COMM_WORLD_LOCAL_SIZE");
  if (rank == nullptr || ranks == nullptr) return std::nullopt;
  const LocalRank local{std::atoi(rank), std::atoi(ranks)};
  return local.rank >= 0 && local.rank < local.ranks ? std::optional(local) : std::nullopt;
}

std::optional<std::string> ranks_without_mpi_error(const Environment& environment) {
  if (!may_have_other_ranks(environment)) return std::nullopt;
  return "this gigabake was built without MPI, so each of the launched processes would bake the whole scene: start one "
         "process without mpirun or srun, or build gigabake with -DGIGABAKE_MPI=ON";
}

std::optional<std::string> unlaunched_rank_error(int ranks, int tasks) {
  if (ranks > 1 || tasks <= 1) return std::nullopt;
  return "Slurm started " + std::to_string(tasks) +
         " tasks, but MPI of this task sees only one rank: start the tasks with `srun --mpi=pmix` (`srun --mpi=list` "
         "lists the available types) or with mpirun; if each task shall bake separately: env -u SLURM_NTASKS -u "
         "SLURM_STEP_NUM_TASKS gigabake …";
}

}  // namespace gigabake
