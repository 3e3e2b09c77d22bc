#include "cluster/launch/launcher.h"

#include <gtest/gtest.h>
#include <map>

namespace gigabake {
namespace {

int tasks(const std::map<std::string, std::string>& variables) {
  return slurm_task_count([&](const char* name) {
    const auto it = variables.find(name);
    return it == variables.end() ? nullptr : it->second.c_str();
  });
}

// Regression of 2026-11-22: each of srun's tasks baked the whole scene.
TEST(LoneTask, IsATaskOfSrunThatFoundNoOthers) {
  EXPECT_EQ(tasks({{"SLURM_NTASKS", "4"}}), 4);
  EXPECT_EQ(tasks({{"SLURM_JOB_ID", "7"}, {"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "3"}}), 3);
  const auto line = unlaunched_rank_error(1, 4);
  ASSERT_TRUE(line);
  EXPECT_NE(line->find("srun --mpi=pmix"), std::string::npos);
  EXPECT_LE(line->size() + std::string("gigabake: ").size(), 300u);
  EXPECT_FALSE(unlaunched_rank_error(4, 4));
}

TEST(LoneTask, IsNoneInABatchScriptNorUnderMpirunNorAlone) {
  EXPECT_EQ(tasks({}), 1);
  EXPECT_EQ(tasks({{"SLURM_JOB_ID", "7"}, {"SLURM_NTASKS", "4"}, {"SLURM_PROCID", "0"}}), 1);
  EXPECT_EQ(tasks({{"SLURM_JOB_ID", "7"}, {"SLURM_NTASKS", "4"}, {"OMPI_COMM_WORLD_SIZE", "1"}}), 1);
  EXPECT_EQ(tasks({{"SLURM_STEP_NUM_TASKS", "3"}, {"OMPI_COMM_WORLD_SIZE", "1"}}), 1);
  EXPECT_EQ(tasks({{"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "1"}, {"SLURM_NTASKS", "4"}}), 1);
  EXPECT_EQ(tasks({{"SLURM_NTASKS", "many"}}), 1);
}

Environment of(const std::map<std::string, std::string>& variables) {
  return [variables](const char* name) {
    const auto it = variables.find(name);
    return it == variables.end() ? nullptr : it->second.c_str();
  };
}

TEST(WithoutMpi, RefusesAllLaunchersOfSeveralProcessesInOneLine) {
  for (const std::map<std::string, std::string>& variables :
       {std::map<std::string, std::string>{{"OMPI_COMM_WORLD_SIZE", "2"}},
        {{"PMI_SIZE", "3"}, {"PMI_RANK", "0"}},
        {{"PMIX_RANK", "1"}},
        {{"PALS_RANKID", "0"}},
        {{"SLURM_JOB_ID", "7"}, {"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "3"}},
        {{"SLURM_NTASKS", "4"}}}) {
    const auto line = ranks_without_mpi_error(of(variables));
    ASSERT_TRUE(line) << variables.begin()->first;
    EXPECT_NE(line->find("-DGIGABAKE_MPI=ON"), std::string::npos);
    EXPECT_LE(line->size() + std::string("gigabake: ").size(), 300u);
  }
}

TEST(WithoutMpi, AcceptsASingleProcess) {
  for (const std::map<std::string, std::string>& variables :
       {std::map<std::string, std::string>{},
        {{"OMPI_COMM_WORLD_SIZE", "1"}, {"PMIX_RANK", "0"}},
        {{"SLURM_JOB_ID", "7"}, {"SLURM_NTASKS", "4"}},
        {{"SLURM_JOB_ID", "7"}, {"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "1"}, {"PMIX_RANK", "0"}}})
    EXPECT_FALSE(ranks_without_mpi_error(of(variables)));
}

/// The error is printed by rank 0 only, so each process must find its rank in the launcher's variables.
TEST(WithoutMpi, KnowsTheRankThatTheLauncherStates) {
  EXPECT_EQ(rank_from_launcher(of({})), 0);
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "PALS_RANKID", "SLURM_PROCID"})
    EXPECT_EQ(rank_from_launcher(of({{name, "3"}})), 3) << name;
}

/// A bake process is started before MPI_Init, for the device of its rank on this host.
TEST(LocalRank, IsTheOneThatTheLauncherStates) {
  const auto alone = local_rank_from_launcher(of({}));
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->rank, 0);
  EXPECT_EQ(alone->ranks, 1);
  const auto third = local_rank_from_launcher(
      of({{"OMPI_COMM_WORLD_LOCAL_RANK", "2"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "4"}, {"OMPI_COMM_WORLD_SIZE", "8"}}));
  ASSERT_TRUE(third);
  EXPECT_EQ(third->rank, 2);
  EXPECT_EQ(third->ranks, 4);
}

TEST(LocalRank, IsUnknownIfTheLauncherDoesNotStateIt) {
  EXPECT_FALSE(local_rank_from_launcher(of({{"PMIX_RANK", "2"}})));
  EXPECT_FALSE(local_rank_from_launcher(of({{"OMPI_COMM_WORLD_SIZE", "8"}, {"OMPI_COMM_WORLD_LOCAL_RANK", "5"}})));
  EXPECT_FALSE(local_rank_from_launcher(
      of({{"OMPI_COMM_WORLD_SIZE", "8"}, {"OMPI_COMM_WORLD_LOCAL_RANK", "4"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "4"}})));
}

bool launched(const char* only) {
  return is_launched([&](const char* name) { return std::string(name) == only ? "1" : nullptr; });
}

/// Detection errors are costly. A launched rank that is not detected would bake everything. An unlaunched process that
/// is taken for a launched one would start 0.3 s later.
TEST(IsLaunched, KnowsTheLaunchersAndNothingElse) {
  for (const char* name :
       {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK", "PMI_FD", "SLURM_STEP_ID"})
    EXPECT_TRUE(launched(name)) << name;
  for (const char* name : {"OMPI_MCA_btl", "SLURM_JOB_ID", "HOME", ""}) EXPECT_FALSE(launched(name)) << name;
}

}  // namespace
}  // namespace gigabake
