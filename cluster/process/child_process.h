/// A child program with a socket to this process. It ends with its owner.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace gigabake {

/// Activity counters of a process since its start. If none of them grows, the process waits or hangs.
struct ProcessActivity {
  std::uint64_t cpu_ticks = 0;  ///< of all threads, in user code and in the kernel; usually 100 per second
  std::uint64_t major_faults = 0;
  std::uint64_t io_bytes = 0;  ///< read and written, cached I/O included; 0 if the kernel does not report it
  friend bool operator==(const ProcessActivity&, const ProcessActivity&) = default;
};

class ChildProcess {
 public:
  /// Starts `program` with `arguments`; the last argument is the descriptor of the child's end of the socket. The child
  /// gets its own process group and this process's environment without mpirun's variables. Its standard output and
  /// error go to this process's standard error, and it inherits no other open file.
  /// Errors  std::system_error naming the call, or the program that cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  /// Closes the socket and waits 100 ms; then kills the process group. A process that the kernel cannot end within 5 s,
  /// for example because it waits for a lost disk, is abandoned.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  /// Returns the parent's end of the socket, which is non-blocking.
  int socket() const { return socket_; }
  /// Sends SIGKILL to the child's process group.
  void kill();
  /// Returns how the process ended: "exit code 1", "killed by signal 11 (SIGSEGV)". Returns nullopt while it runs.
  const std::optional<std::string>& ended();
  /// Returns the activity counters; nullopt if the process ended or /proc does not show it.
  std::optional<ProcessActivity> activity() const;
  /// Returns the peak memory of the process in bytes.
  std::uint64_t peak_bytes() const;

 private:
  void end_within(std::chrono::milliseconds time);

  pid_t pid_ = -1;
  int socket_ = -1;
  std::uint64_t final_peak_bytes_ = 0;
  std::optional<std::string> ended_;
};

}  // namespace gigabake
