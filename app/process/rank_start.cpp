#include "app/process/rank_start.h"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "cluster/launch/launcher.h"
#include "cluster/launch/local_ranks.h"
#include "cluster/mpi/mpi_version.h"
#include "core/base/error.h"
#include "format/system/message.h"
#include "worker/device/backend.h"

namespace gigabake::app {
namespace {

constexpr int max_ranks = 1024;

void expect_start_of_ranks(int ranks) {
  if (ranks < 1 || ranks > max_ranks)
    throw UsageError(fmt::format("--ranks: expected 1 to {}, got {}", max_ranks, ranks));
  if (is_launched(environment_of_process))
    throw UsageError("--ranks: mpirun or another launcher started this process and sets the number of ranks");
  if (ranks > 1 && !has_mpi()) throw UsageError("--ranks: this gigabake was built without MPI");
  if (ranks > 1 && !find_mpirun(environment_of_process)) throw UsageError("--ranks: mpirun is not in PATH");
}

/// Returns the number of different GPUs that the bake may use; 0 if it shall not or cannot use any.
int usable_gpus(const BakeOptions& options) {
  if (options.asked.backend == Backend::cpu || !is_built_for_devices()) return 0;
  const int visible = visible_gpus(environment_of_process);
  if (options.asked.gpus.empty()) return visible;
  return std::min(visible, int(std::set<int>(options.asked.gpus.begin(), options.asked.gpus.end()).size()));
}

/// Returns the arguments of this process without --ranks and its value.
std::vector<std::string> arguments_without_ranks() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string line{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < line.size(); begin += words.back().size() + 1)
    words.emplace_back(line.c_str() + begin);
  if (!words.empty()) words.erase(words.begin());
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t count = words[i] == "--ranks" ? 2 : words[i].starts_with("--ranks=") ? 1 : 0;
    if (count == 0) ++i;
    words.erase(words.begin() + std::ptrdiff_t(i), words.begin() + std::ptrdiff_t(std::min(i + count, words.size())));
  }
  return words;
}

}  // namespace

std::optional<int> ranks_to_start(const BakeOptions& options) {
  if (options.ranks) {
    expect_start_of_ranks(*options.ranks);
    return *options.ranks > 1 ? options.ranks : std::nullopt;
  }
  if (!has_mpi() || !may_start_ranks(environment_of_process)) return std::nullopt;
  const int gpus = usable_gpus(options);
  if (gpus < 2) return std::nullopt;
  if (find_mpirun(environment_of_process)) return gpus;
  print_message("gigabake: one of {} GPUs is used, because mpirun is not in PATH\n", gpus);
  return std::nullopt;
}

int run_on_ranks(const BakeOptions& options, int ranks) {
  if (!options.quiet) print_message("{} ranks on this host; --ranks changes their number\n", ranks);
  return run_local_ranks(*find_mpirun(environment_of_process), ranks, std::filesystem::read_symlink("/proc/self/exe"),
                         arguments_without_ranks());
}

}  // namespace gigabake::app
