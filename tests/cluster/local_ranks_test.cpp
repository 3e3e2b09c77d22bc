#include "cluster/launch/local_ranks.h"

#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "tests/worker/glb_scene.h"

namespace gigabake {
namespace {

Environment with(std::map<std::string, std::string> variables) {
  return [variables = std::move(variables)](const char* name) {
    const auto it = variables.find(name);
    return it == variables.end() ? nullptr : it->second.c_str();
  };
}

TEST(VisibleGpus, AreTheDriversFilesThatTheEnvironmentLists) {
  const ScratchFolder devices;
  for (const char* name : {"nvidia0", "nvidia1", "nvidia12", "nvidiactl", "nvidia-uvm", "nvidia", "nvme0", "null"})
    std::ofstream(devices.path() / name);
  EXPECT_EQ(visible_gpus(with({}), devices.path()), 3);
  EXPECT_EQ(visible_gpus(with({{"CUDA_VISIBLE_DEVICES", ""}}), devices.path()), 0);
  EXPECT_EQ(visible_gpus(with({{"CUDA_VISIBLE_DEVICES", "12"}}), devices.path()), 1);
  EXPECT_EQ(visible_gpus(with({{"CUDA_VISIBLE_DEVICES", "0,1"}}), devices.path()), 2);
  EXPECT_EQ(visible_gpus(with({{"CUDA_VISIBLE_DEVICES", "0,1,2,3,4"}}), devices.path()), 3);
  EXPECT_EQ(visible_gpus(with({}), devices.path() / "missing"), 0);
}

TEST(Ranks, AreNotStartedUnderALauncherOrInABatchJob) {
  EXPECT_TRUE(may_start_ranks(with({})));
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID"})
    EXPECT_FALSE(may_start_ranks(with({{name, "1"}}))) << name;
}

TEST(Mpirun, IsFoundInThePath) {
  const ScratchFolder folder;
  const auto mpirun = folder.path() / "mpirun";
  const std::string path = "/nonexistent::" + folder.path().string();
  EXPECT_EQ(find_mpirun(with({})), std::nullopt);
  EXPECT_EQ(find_mpirun(with({{"PATH", path}})), std::nullopt);
  std::ofstream(mpirun) << "";
  EXPECT_EQ(find_mpirun(with({{"PATH", path}})), std::nullopt) << "is not executable";
  std::filesystem::permissions(mpirun, std::filesystem::perms::owner_exec, std::filesystem::perm_options::add);
  EXPECT_EQ(find_mpirun(with({{"PATH", path}})), mpirun);
}

}  // namespace
}  // namespace gigabake
