#include "format/system/host_limits.h"

#include <fstream>
#include <gtest/gtest.h>
#include <map>

namespace gigabake {
namespace {

/// 2026-11-22: the numbers of threads and bytes ignored the limits of the container.
class HostLimitsTest : public testing::Test {
 protected:
  HostLimitsTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::path(testing::TempDir()) / "host_limits" / test->name();
    std::filesystem::remove_all(root_);
    write("proc/meminfo", "MemTotal:       131072000 kB\nMemFree: 1 kB\n");
  }
  ~HostLimitsTest() override { std::filesystem::remove_all(root_); }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  HostLimits limits(const std::map<std::string, std::string>& variables = {}) const {
    const auto value = [&](const char* name) {
      const auto it = variables.find(name);
      return it == variables.end() ? nullptr : it->second.c_str();
    };
    return limits_from(root_, value, 96);
  }

  std::filesystem::path root_;
};

TEST_F(HostLimitsTest, AreTheHostsWhereNothingIsNarrower) {
  EXPECT_EQ(limits().cores(), 96);
  EXPECT_EQ(limits().memory_bytes, std::uint64_t(131072000) * 1024);
}

/// 2026-11-22: all 96 cores of the host were used, and more memory than the container has.
TEST_F(HostLimitsTest, ObeyAContainerOfTwoCpusAndAGigabyte) {
  write("proc/self/cgroup", "0::/\n");
  write("sys/fs/cgroup/cpu.max", "200000 100000\n");
  write("sys/fs/cgroup/memory.max", "1073741824\n");
  EXPECT_EQ(limits().cores(), 2);
  EXPECT_EQ(limits().memory_bytes, 1073741824u);
}

TEST_F(HostLimitsTest, AreTheMinOfAllParentGroups) {
  write("proc/self/cgroup", "0::/kube/pod/box\n");
  write("sys/fs/cgroup/kube/pod/box/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/kube/pod/cpu.max", "150000 100000\n");
  write("sys/fs/cgroup/kube/cpu.max", "800000 100000\n");
  write("sys/fs/cgroup/kube/pod/box/memory.max", "max\n");
  write("sys/fs/cgroup/kube/memory.high", "5000000000\n");
  EXPECT_EQ(limits().cores(), 2) << "a share of a core counts as one";
  EXPECT_EQ(limits().memory_bytes, 5000000000u);
}

TEST_F(HostLimitsTest, ObeyGroupsOfVersion1) {
  write("proc/self/cgroup", "5:memory:/docker/a\n4:cpu,cpuacct:/docker/a\n");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/cpu,cpuacct/docker/a/cpu.cfs_quota_us", "300000\n");
  write("sys/fs/cgroup/cpu,cpuacct/docker/a/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("sys/fs/cgroup/memory/docker/a/memory.limit_in_bytes", "2147483648\n");
  EXPECT_EQ(limits().cores(), 3);
  EXPECT_EQ(limits().memory_bytes, 2147483648u);
}

TEST_F(HostLimitsTest, ObeySlurm) {
  const HostLimits batch = limits(
      {{"SLURM_JOB_ID", "1"}, {"SLURM_CPUS_ON_NODE", "8"}, {"SLURM_CPUS_PER_TASK", "2"}, {"SLURM_MEM_PER_CPU", "512"}});
  EXPECT_EQ(batch.cores(), 8) << "the batch script is no task";
  EXPECT_EQ(batch.memory_bytes, std::uint64_t(8 * 512) << 20);
  const HostLimits task = limits({{"SLURM_STEP_ID", "0"}, {"SLURM_CPUS_ON_NODE", "8"}, {"SLURM_CPUS_PER_TASK", "2"}});
  EXPECT_EQ(task.cores(), 2);
  EXPECT_EQ(task.shared_cores, 8);
  EXPECT_EQ(limits({{"SLURM_MEM_PER_NODE", "1024"}}).memory_bytes, std::uint64_t(1) << 30);
  const HostLimits daemon =
      limits({{"SLURM_STEP_ID", "0"}, {"SLURM_CPUS_ON_NODE", "1"}, {"OMPI_COMM_WORLD_RANK", "3"}});
  EXPECT_EQ(daemon.cores(), 96) << "the step is that of mpirun's daemon";
}

TEST_F(HostLimitsTest, TakeNonsenseForNoLimit) {
  write("proc/self/cgroup", "0::/../../etc\nnonsense\n7:cpu:\n");
  write("proc/meminfo", "MemTotal: many\n");
  write("sys/fs/cgroup/cpu.max", "-5 0\n");
  write("sys/fs/cgroup/memory.max", "\n");
  EXPECT_EQ(limits({{"SLURM_CPUS_ON_NODE", "x"}, {"SLURM_MEM_PER_NODE", "0"}}).cores(), 96);
  EXPECT_GT(limits().memory_bytes, std::uint64_t(1) << 50);
}

TEST(UsualMemory, IsHalfOfAFairShareAtMost) {
  const std::uint64_t gib = std::uint64_t(1) << 30;
  EXPECT_EQ(default_memory(4 * gib, 64 * gib, 1), 4 * gib);
  EXPECT_EQ(default_memory(4 * gib, gib, 1), gib / 2);
  EXPECT_EQ(default_memory(4 * gib, 8 * gib, 4), gib);
  EXPECT_EQ(default_memory(4 * gib, 1, 100), std::uint64_t(64) << 20);
}

TEST(HostLimits, OfThisProcessAreAtLeastACoreAndAtMostTheHosts) {
  EXPECT_GE(host_limits().cores(), 1);
  EXPECT_LE(host_limits().cores(), int(cores_of_this_process().count()));
  EXPECT_GT(host_limits().memory_bytes, std::uint64_t(1) << 26);
}

}  // namespace
}  // namespace gigabake
