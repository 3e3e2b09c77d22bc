#include "cluster/process/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <initializer_list>
#include <spawn.h>
#include <sstream>
#include <string_view>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include "core/base/quote.h"

extern char** environ;

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds time_to_end{100}, time_to_be_killed{5000};
constexpr int child_socket = 3;  // the first descriptor after the standard streams

void check(int error, const std::string& call) {
  if (error != 0) throw std::system_error(error, std::generic_category(), call);
}

/// A pair of sockets that close on exec.
struct SocketPair {
  std::array<int, 2> fd{-1, -1};
  SocketPair() {
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fd.data()) != 0) check(errno, "socketpair");
  }
  ~SocketPair() {
    for (const int end : fd)
      if (end >= 0) ::close(end);
  }
  SocketPair(const SocketPair&) = delete;
  SocketPair& operator=(const SocketPair&) = delete;
};

/// Attributes for posix_spawn: the child's files, process group and signal mask.
class SpawnPlan {
 public:
  explicit SpawnPlan(int socket) {
    check(::posix_spawn_file_actions_init(&files_), "posix_spawn_file_actions_init");
    check(::posix_spawnattr_init(&attributes_), "posix_spawnattr_init");
    sigset_t none;
    ::sigemptyset(&none);
    check(::posix_spawn_file_actions_adddup2(&files_, socket, child_socket), "posix_spawn_file_actions_adddup2");
    check(::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0),
          "posix_spawn_file_actions_addopen");
    // This process's standard output is reserved for its own result.
    check(::posix_spawn_file_actions_adddup2(&files_, STDERR_FILENO, STDOUT_FILENO),
          "posix_spawn_file_actions_adddup2");
    // Closes inherited descriptors, mainly MPI's sockets: some of them do not close on exec.
    check(::posix_spawn_file_actions_addclosefrom_np(&files_, child_socket + 1),
          "posix_spawn_file_actions_addclosefrom_np");
    check(::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK),
          "posix_spawnattr_setflags");
    check(::posix_spawnattr_setpgroup(&attributes_, 0), "posix_spawnattr_setpgroup");
    check(::posix_spawnattr_setsigmask(&attributes_, &none), "posix_spawnattr_setsigmask");
  }
  ~SpawnPlan() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  pid_t run(const std::filesystem::path& program, char** arguments, char** environment) const {
    pid_t pid = -1;
    check(::posix_spawn(&pid, program.c_str(), &files_, &attributes_, arguments, environment),
          "cannot start " + short_path(program.string()));
    return pid;
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

/// Returns the environment without mpirun's variables: with them, a child that initializes MPI would act as this rank.
std::vector<char*> environment_without_mpi() {
  std::vector<char*> out;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::initializer_list<std::string_view> of_mpi = {"OMPI_", "PMIX_", "PMI_", "PRTE_"};
    if (std::ranges::none_of(of_mpi, [&](std::string_view start) { return text.starts_with(start); }))
      out.push_back(*entry);
  }
  out.push_back(nullptr);
  return out;
}

std::string describe_status(int status) {
  if (WIFEXITED(status)) return "exit code " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* name = ::sigabbrev_np(signal);
  return "killed by signal " + std::to_string(signal) + (name == nullptr ? "" : std::string(" (SIG") + name + ")");
}

std::string content(pid_t pid, const char* file) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/" + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the number after `key`, or 0.
std::uint64_t number_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  return at == std::string::npos ? 0 : std::strtoull(text.c_str() + at + key.size(), nullptr, 10);
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  SocketPair ends;
  const int flags = ::fcntl(ends.fd[0], F_GETFL);
  if (flags < 0 || ::fcntl(ends.fd[0], F_SETFL, flags | O_NONBLOCK) != 0) check(errno, "fcntl");
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), "gigabake");
  words.push_back(std::to_string(child_socket));
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_ = SpawnPlan(ends.fd[1]).run(program, pointers.data(), environment_without_mpi().data());
  socket_ = std::exchange(ends.fd[0], -1);
}

ChildProcess::~ChildProcess() {
  ::close(socket_);
  end_within(time_to_end);
  if (ended()) return;
  kill();
  end_within(time_to_be_killed);
}

void ChildProcess::end_within(std::chrono::milliseconds time) {
  const auto last = std::chrono::steady_clock::now() + time;
  while (!ended() && std::chrono::steady_clock::now() < last) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void ChildProcess::kill() {
  if (!ended()) ::kill(-pid_, SIGKILL);  // fails only if no process is left
}

const std::optional<std::string>& ChildProcess::ended() {
  if (ended_) return ended_;
  int status = 0;
  rusage usage{};
  const pid_t who = ::wait4(pid_, &status, WNOHANG, &usage);
  if (who == pid_) {
    final_peak_bytes_ = std::uint64_t(usage.ru_maxrss) * 1024;
    ended_ = describe_status(status);
  } else if (who < 0 && errno != EINTR) {
    ended_ = std::string("unknown end: wait4: ") + std::strerror(errno);  // another caller has waited for it
  }
  return ended_;
}

std::optional<ProcessActivity> ChildProcess::activity() const {
  if (ended_) return std::nullopt;
  const std::string stat = content(pid_, "stat");
  const std::size_t name_end = stat.rfind(')');  // the name may contain any characters
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(stat.substr(name_end + 1));
  constexpr int fields_before_major_faults = 9;  // state … cminflt
  std::string skipped;
  for (int i = 0; i < fields_before_major_faults; ++i) fields >> skipped;
  std::uint64_t major_faults = 0, of_children = 0, user = 0, system = 0;
  if (!(fields >> major_faults >> of_children >> user >> system)) return std::nullopt;
  const std::string io = content(pid_, "io");
  return ProcessActivity{user + system, major_faults, number_after(io, "rchar:") + number_after(io, "wchar:")};
}

std::uint64_t ChildProcess::peak_bytes() const {
  return ended_ ? final_peak_bytes_ : number_after(content(pid_, "status"), "VmHWM:") * 1024;
}

}  // namespace gigabake
