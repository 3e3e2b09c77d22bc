/// A program that runs beside this one, with a socket between them. It does not outlive its owner.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace gigabake {

/// What a process has done since its start. Where nothing of it grows, the process waits or hangs.
struct ProcessActivity {
  std::uint64_t cpu_ticks = 0;  ///< of all threads, in user code and in the kernel; usually 100 a second
  std::uint64_t major_faults = 0;
  std::uint64_t io_bytes = 0;  ///< read and written, from caches too; 0 where the kernel does not tell
  friend bool operator==(const ProcessActivity&, const ProcessActivity&) = default;
};

class ChildProcess {
 public:
  /// Starts `program` with `arguments` and, as its last one, the number of its end of the socket. It gets a process
  /// group of its own, this process's environment without what mpirun put there, its standard error (for standard
  /// output too), and no other open file.
  /// Errors  std::system_error naming the call, or the program that cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  /// Hangs up, gives it 100 ms to end, then kills it and whatever it started. One that even the kernel cannot end (it
  /// waits for a disk that is gone) is left to itself after 5 s.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  /// Never blocks.
  int socket() const { return socket_; }
  /// SIGKILL to its process group.
  void kill();
  /// How it ended, once it has: "exit code 1", "killed by signal 11 (SIGSEGV)".
  const std::optional<std::string>& ended();
  /// None: it ended, or /proc does not show it.
  std::optional<ProcessActivity> activity() const;
  /// The most memory that it ever had.
  std::uint64_t peak_bytes() const;

 private:
  void end_within(std::chrono::milliseconds time);

  pid_t pid_ = -1;
  int socket_ = -1;
  std::uint64_t final_peak_bytes_ = 0;
  std::optional<std::string> ended_;
};

}  // namespace gigabake
