#include "cluster/launch/local_ranks.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <string_view>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "cluster/launch/launcher.h"

namespace gigabake {
namespace {

constexpr int exec_failed = 127;

std::optional<std::filesystem::path> find_in_path(const char* path, const std::string& program) {
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::filesystem::path file = std::filesystem::path(rest.substr(0, end)) / program;
    if (::access(file.c_str(), X_OK) == 0) return file;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return std::nullopt;
}

/// Sets what Open MPI needs on one host, unless the user has set it. Root may run it, no remote shell is needed, and
/// ranks may outnumber the cores, which they divide themselves.
void set_mpi_environment() {
  const auto set = [](const char* name, const char* value) { ::setenv(name, value, 0); };
  if (::geteuid() == 0) set("OMPI_ALLOW_RUN_AS_ROOT", "1"), set("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
  if (!find_in_path(std::getenv("PATH"), "ssh")) set("OMPI_MCA_plm_rsh_agent", "/bin/false");
  set("OMPI_MCA_rmaps_base_oversubscribe", "1");
  set("OMPI_MCA_hwloc_base_binding_policy", "none");
  set("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
  set("HWLOC_COMPONENTS", hwloc_without_gpus);
}

sigset_t awaited_signals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGCHLD}) ::sigaddset(&signals, signal);
  return signals;
}

/// Replaces the child of fork() by mpirun. The child has its own process group, so that the terminal's Ctrl-C reaches
/// only the parent, which passes it on.
[[noreturn]] void become_mpirun(const std::vector<std::string>& words, const sigset_t& former) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &former, nullptr);
  if (const int null = ::open("/dev/null", O_RDONLY); null >= 0) ::dup2(null, STDIN_FILENO);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  set_mpi_environment();
  ::execv(argv[0], argv.data());
  ::_exit(exec_failed);
}

/// Passes stop requests on to mpirun until it ends. mpirun passes SIGUSR1 on to the ranks; SIGTERM ends them.
int wait_for(pid_t mpirun, const sigset_t& signals) {
  for (int interrupts = 0;;) {
    const int signal = ::sigwaitinfo(&signals, nullptr);
    int status = 0;
    if (signal == SIGCHLD && ::waitpid(mpirun, &status, WNOHANG) == mpirun)
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (signal == SIGINT) ++interrupts;
    if (signal == SIGINT || signal == SIGTERM || signal == SIGUSR1) ::kill(mpirun, interrupts > 1 ? SIGTERM : SIGUSR1);
  }
}

}  // namespace

int visible_gpus(const Environment& environment, const std::filesystem::path& devices) {
  int files = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(devices, error)) {
    const std::string name = entry.path().filename();
    const std::string number = name.starts_with("nvidia") ? name.substr(6) : "";
    files +=
        !number.empty() && std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isdigit(c); });
  }
  const char* visible = environment("CUDA_VISIBLE_DEVICES");
  if (visible == nullptr) return files;
  const std::string_view list = visible;
  return list.empty() ? 0 : std::min(files, 1 + int(std::count(list.begin(), list.end(), ',')));
}

bool may_start_ranks(const Environment& environment) {
  constexpr const char* of_batch_jobs[] = {"SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "FLUX_JOB_ID", "COBALT_JOBID"};
  return !is_launched(environment) && std::none_of(std::begin(of_batch_jobs), std::end(of_batch_jobs),
                                                   [&](const char* name) { return environment(name) != nullptr; });
}

std::optional<std::filesystem::path> find_mpirun(const Environment& environment) {
  return find_in_path(environment("PATH"), "mpirun");
}

int run_local_ranks(const std::filesystem::path& mpirun, int ranks, const std::filesystem::path& program,
                    const std::vector<std::string>& arguments) {
  std::vector<std::string> words{mpirun, "-q", "--bind-to", "none", "-n", std::to_string(ranks), program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const sigset_t signals = awaited_signals();
  sigset_t former;
  ::sigprocmask(SIG_BLOCK, &signals, &former);
  const pid_t child = ::fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) become_mpirun(words, former);
  const int status = wait_for(child, signals);
  ::sigprocmask(SIG_SETMASK, &former, nullptr);
  if (status == exec_failed) throw std::system_error(ENOEXEC, std::generic_category(), mpirun.string());
  return status;
}

}  // namespace gigabake
