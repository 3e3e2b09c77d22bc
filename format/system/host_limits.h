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

/// Returns the cores on which this process may run (sched_getaffinity); mpirun may have bound it to a few.
CoreSet cores_of_this_process();

struct HostLimits {
  int allowed_cores = 1;           ///< cores on which the process may run
  int shared_cores = INT_MAX;      ///< max concurrently used cores, of all processes of its container or job on this
                                   ///< host
  int task_cores = INT_MAX;        ///< cores of this task of a Slurm step
  std::uint64_t memory_bytes = 0;  ///< of all processes of its container or job on this host

  /// Returns the cores available to a process without others on its host; at least 1.
  int cores() const;
};

/// Returns the value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// Returns the min of all limits. Control groups: cpu.max and memory.max of v2, from the process's own group upwards,
/// and their v1 counterparts. Slurm: SLURM_CPUS_ON_NODE, SLURM_CPUS_PER_TASK, SLURM_MEM_PER_NODE and SLURM_MEM_PER_CPU.
/// Other limits: the mask and MemTotal. A fraction of a core counts as one. `root` is the folder that contains /proc
/// and /sys.
/// Exact   A pure function of its arguments and of the files below root.
/// Errors  None: missing or invalid values impose no limit.
HostLimits limits_from(const std::filesystem::path& root, const Environment& environment, int allowed_cores);

/// Returns the limits of this process.
HostLimits host_limits();

/// Returns the memory to use if the user specified none: `wished`, or half of a fair share if that is less; at least 64
/// MiB.
std::uint64_t default_memory(std::uint64_t wished, std::uint64_t memory_bytes, int processes);

}  // namespace gigabake
