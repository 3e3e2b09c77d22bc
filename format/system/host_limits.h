/// The resources of the host that a process may use. A container, a batch system or an affinity mask may grant less
/// than the host has. All code that chooses a number of threads or bytes uses this file.
#pragma once

#include <bitset>
#include <climits>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace gigabake {

/// A set of cores; bit c is core c.
using CoreSet = std::bitset<1024>;

/// Returns the cores on which this process may run (sched_getaffinity); mpirun may have bound the process to some of
/// the host's cores.
CoreSet cores_of_this_process();

struct HostLimits {
  int allowed_cores = 1;  ///< cores on which the process may run
  /// Max cores that all processes of its container or job on this host may use together.
  int shared_cores = INT_MAX;
  int task_cores = INT_MAX;  ///< cores of this task of a Slurm step
  /// Max memory that all processes of its container or job on this host may use together.
  std::uint64_t memory_bytes = 0;

  /// Returns the number of cores that the process may use if it is the only process of its job on the host; at least 1.
  int cores() const;
};

/// A function that returns the value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// Returns the value of an environment variable of this process, or null. It is the usual Environment.
const char* environment_of_process(const char* name);

/// Returns the min of all limits of a process. Control groups have the limits cpu.max, memory.max and memory.high (v2)
/// or their v1 counterparts, from the process's own group upwards. Slurm has the limits SLURM_CPUS_ON_NODE,
/// SLURM_CPUS_PER_TASK, SLURM_MEM_PER_NODE and SLURM_MEM_PER_CPU. Further limits are `allowed_cores` and MemTotal in
/// /proc/meminfo. A fraction of a core counts as one. `root` is the folder that contains /proc and /sys.
/// Exact   The result depends only on the arguments and on the files below `root`.
/// Errors  None: missing or invalid values impose no limit.
HostLimits limits_from(const std::filesystem::path& root, const Environment& environment, int allowed_cores);

/// Returns the limits of this process.
HostLimits host_limits();

/// Returns the memory, in bytes, to use if the user specified none. The result is `wished`, or half of memory_bytes /
/// processes if that is less. It is not below 64 MiB unless `wished` is.
std::uint64_t default_memory(std::uint64_t wished, std::uint64_t memory_bytes, int processes);

}  // namespace gigabake
