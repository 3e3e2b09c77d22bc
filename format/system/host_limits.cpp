#include "format/system/host_limits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sched.h>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace gigabake {
namespace {

constexpr std::uint64_t mebi = std::uint64_t(1) << 20;
constexpr std::uint64_t min_memory = 64 * mebi;
constexpr double no_limit = HUGE_VAL;

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end == text.data() || !(value > 0)) return std::nullopt;
  return value;
}

std::optional<double> number_in(const Environment& environment, const char* name) {
  const char* text = environment(name);
  return text == nullptr ? std::nullopt : number_in(std::string(text));
}

/// Returns the first words, at most eight, of a file; no words if the file does not exist.
std::vector<std::string> words_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> words;
  for (std::string word; words.size() < 8 && in >> word;) words.push_back(word);
  return words;
}

struct GroupLimits {
  double cores = no_limit, bytes = no_limit;
};

/// Reads the limits of a v2 group. cpu.max is "max 100000" or "200000 100000": a quota of CPU time and a period, in
/// microseconds.
void take_v2(const std::filesystem::path& group, GroupLimits& limits) {
  const auto cpu = words_of(group / "cpu.max");
  if (cpu.size() == 2)
    if (const auto quota = number_in(cpu[0]), period = number_in(cpu[1]); quota && period)
      limits.cores = std::min(limits.cores, *quota / *period);
  for (const char* name : {"memory.max", "memory.high"})
    if (const auto words = words_of(group / name); !words.empty())
      limits.bytes = std::min(limits.bytes, number_in(words[0]).value_or(no_limit));
}

/// Reads the limits of a v1 group. A quota of -1 means no limit; unlimited memory is a number larger than any memory.
void take_v1(const std::filesystem::path& group, GroupLimits& limits) {
  const auto quota = words_of(group / "cpu.cfs_quota_us"), period = words_of(group / "cpu.cfs_period_us");
  if (!quota.empty() && !period.empty())
    if (const auto q = number_in(quota[0]), p = number_in(period[0]); q && p)
      limits.cores = std::min(limits.cores, *q / *p);
  if (const auto bytes = words_of(group / "memory.limit_in_bytes"); !bytes.empty())
    limits.bytes = std::min(limits.bytes, number_in(bytes[0]).value_or(no_limit));
}

/// Calls take(group) for a group and all its ancestors, up to the mount point.
template <class Take>
void climb(const std::filesystem::path& mount, std::string path, const Take& take) {
  while (true) {
    take(path.empty() ? mount : mount / path.substr(1));
    if (path.empty()) return;
    path.erase(path.rfind('/'));
  }
}

/// Returns the limits of control groups. /proc/self/cgroup has lines "4:cpu,cpuacct:/path"; version 2 has "0::/path".
GroupLimits group_limits(const std::filesystem::path& root) {
  GroupLimits limits;
  const std::filesystem::path groups = root / "sys/fs/cgroup";
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    std::string path = line.substr(second + 1);
    if (path.empty() || path[0] != '/' || path.find("..") != std::string::npos) path = "/";
    if (path.back() == '/') path.pop_back();
    if (controllers.empty()) {
      climb(groups, path, [&](const std::filesystem::path& group) { take_v2(group, limits); });
      continue;
    }
    climb(groups / controllers, path, [&](const std::filesystem::path& group) { take_v1(group, limits); });
    std::istringstream names(controllers);  // controllers that are mounted together have a link each
    for (std::string name; std::getline(names, name, ',');)
      climb(groups / name, path, [&](const std::filesystem::path& group) { take_v1(group, limits); });
  }
  return limits;
}

std::optional<double> total_memory(const std::filesystem::path& root) {
  std::ifstream in(root / "proc/meminfo");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name, kilobytes;
    if (words >> name >> kilobytes && name == "MemTotal:")
      if (const auto value = number_in(kilobytes)) return *value * 1024;
  }
  return std::nullopt;
}

/// Returns whether mpirun's daemon started this process. The daemons are a separate Slurm step, whose numbers do not
/// describe ranks.
bool is_below_daemon_of_mpirun(const Environment& environment) {
  return environment("OMPI_COMM_WORLD_RANK") != nullptr && environment("SLURM_STEP_ID") != nullptr;
}

int whole_cores(double cores) { return cores < INT_MAX ? std::max(1, int(std::ceil(cores))) : INT_MAX; }

}  // namespace

CoreSet cores_of_this_process() {
  CoreSet cores;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) == 0) {
    for (std::size_t c = 0; c < cores.size(); ++c) cores[c] = CPU_ISSET(c, &set);
  } else {  // the kernel has more cores than the set can hold
    for (std::size_t c = 0; c < std::min<std::size_t>(std::thread::hardware_concurrency(), cores.size()); ++c)
      cores.set(c);
  }
  return cores;
}

int HostLimits::cores() const { return std::max(1, std::min({allowed_cores, shared_cores, task_cores})); }

HostLimits limits_from(const std::filesystem::path& root, const Environment& environment, int allowed_cores) {
  const GroupLimits group = group_limits(root);
  const std::optional<double> on_node = number_in(environment, "SLURM_CPUS_ON_NODE");
  double cores = group.cores, bytes = std::min(group.bytes, total_memory(root).value_or(no_limit));
  if (on_node && !is_below_daemon_of_mpirun(environment)) cores = std::min(cores, *on_node);
  if (const auto megabytes = number_in(environment, "SLURM_MEM_PER_NODE"))
    bytes = std::min(bytes, *megabytes * double(mebi));
  if (const auto megabytes = number_in(environment, "SLURM_MEM_PER_CPU"); megabytes && on_node)
    bytes = std::min(bytes, *megabytes * *on_node * double(mebi));
  HostLimits limits;
  limits.allowed_cores = std::max(1, allowed_cores);
  limits.shared_cores = whole_cores(cores);
  if (environment("SLURM_STEP_ID") != nullptr)
    limits.task_cores = whole_cores(number_in(environment, "SLURM_CPUS_PER_TASK").value_or(no_limit));
  limits.memory_bytes = bytes < 1e18 ? std::uint64_t(bytes) : std::uint64_t(1e18);
  return limits;
}

const char* environment_of_process(const char* name) { return std::getenv(name); }

HostLimits host_limits() { return limits_from("/", environment_of_process, int(cores_of_this_process().count())); }

std::uint64_t default_memory(std::uint64_t wished, std::uint64_t memory_bytes, int processes) {
  return std::clamp(memory_bytes / 2 / std::uint64_t(std::max(1, processes)), std::min(min_memory, wished), wished);
}

}  // namespace gigabake
