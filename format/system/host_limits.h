/// What of its host a process may use: a container, a batch system or a mask may have given it less than there is. The
/// one place that knows; whatever guesses a number of threads or bytes asks here.
#pragma once

#include <bitset>
#include <climits>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace gigabake {

/// Bit c: core c.
using CoreSet = std::bitset<1024>;

/// Those that this process may run on (sched_getaffinity): mpirun may have bound it to a few.
CoreSet cores_of_this_process();

struct HostLimits {
  int allowed_cores = 1;           ///< that the process may run on
  int shared_cores = INT_MAX;      ///< at a time, of all processes in its container or job on this host together
  int task_cores = INT_MAX;        ///< of this task of a Slurm step
  std::uint64_t memory_bytes = 0;  ///< of all processes in its container or job on this host together

  /// Of a process that is alone; at least 1.
  int cores() const;
};

/// Value of a variable, or null.
using Environment = std::function<const char*(const char*)>;

/// The narrowest of: the mask; cpu.max and memory.max of control groups v2, from the process's own upwards, and what v1
/// calls them; SLURM_CPUS_ON_NODE, SLURM_CPUS_PER_TASK, SLURM_MEM_PER_NODE and SLURM_MEM_PER_CPU; MemTotal. A share of
/// a core counts as one. root: where /proc and /sys are. Exact   A function of its arguments and of the files below
/// root. Errors  None: what is missing or makes no sense limits nothing.
HostLimits limits_from(const std::filesystem::path& root, const Environment& environment, int allowed_cores);

/// Of this process.
HostLimits host_limits();

/// Bytes to aim for where nobody said how many: `wished`, or half of a fair share where that is less; at least 64 MiB.
std::uint64_t usual_memory(std::uint64_t wished, std::uint64_t memory_bytes, int processes);

}  // namespace gigabake
