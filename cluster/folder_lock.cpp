#include "cluster/folder_lock.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "cluster/collective.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

constexpr std::chrono::seconds longest_end{30};

std::filesystem::path lock_path(const std::filesystem::path& folder) { return folder / ".lock"; }

struct flock whole_file() {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  return range;
}

bool try_lock(const Descriptor& file) {
  struct flock range = whole_file();
  return ::fcntl(file.get(), F_OFD_SETLK, &range) == 0;
}

/// Whoever held the lock before may have removed the file in the meantime: a lock on it then keeps nobody out.
bool is_still_there(const Descriptor& file, const std::filesystem::path& path) {
  struct stat ours {
  }, there{};
  return ::fstat(file.get(), &ours) == 0 && ::stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

/// What the holder wrote, on one line.
std::string name_in(const Descriptor& file) {
  std::array<char, 200> text{};
  const ssize_t bytes = ::pread(file.get(), text.data(), text.size(), 0);
  std::string line(text.data(), std::size_t(std::max<ssize_t>(0, bytes)));
  line.erase(std::min(line.find('\n'), line.size()));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 32) c = '?';
  return line.empty() ? "a process that has not said who it is" : line;
}

/// Bit SIGKILL - 1 of the line of /proc/PID/status, a mask in hexadecimal digits.
bool has_kill_pending(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string key, value; status >> key && std::getline(status, value);)
    if ((key == "SigPnd:" || key == "ShdPnd:") && (std::stoull(value, nullptr, 16) >> (SIGKILL - 1) & 1) != 0)
      return true;
  return false;
}

/// Whether the holder is a process of this host that was killed and still ends: what it was writing must reach the disk
/// before the system closes its files, which can take seconds.
bool is_ending(const std::string& holder) {
  long process = 0;
  std::array<char, 200> host{};
  if (std::sscanf(holder.c_str(), "process %ld on %199s since", &process, host.data()) != 2) return false;
  if (process <= 0 || host.data() != host_name()) return false;
  std::error_code code;
  const auto program = std::filesystem::read_symlink("/proc/" + std::to_string(process) + "/exe", code);
  // A process that has given its memory back has no program any more; one of somebody else's does not show it.
  const bool has_given_back = program.empty() && code != std::errc::permission_denied;
  return has_given_back || has_kill_pending(pid_t(process));
}

/// False: somebody has it who goes on, or does not end.
bool lock_after_end(const Descriptor& file) {
  const auto start = std::chrono::steady_clock::now();
  while (!try_lock(file)) {
    if (errno != EAGAIN && errno != EACCES) return false;
    if (std::chrono::steady_clock::now() - start > longest_end || !is_ending(name_in(file))) {
      errno = EAGAIN;
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

std::string our_name() {
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("process {} on {} since {:%Y-%m-%dT%H:%M:%SZ}\n", ::getpid(), host_name(),
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw InputError(path, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(lock_path(folder)) {
  do {
    file_ = Descriptor(path_, O_RDWR | O_CREAT);
    if (!file_.is_open()) fail(path_, "open");
    if (lock_after_end(file_)) continue;
    if (errno != EAGAIN && errno != EACCES) fail(path_, "lock (Lustre needs the mount option flock)");
    throw InputError(folder, "", "is being baked into by " + name_in(file_));
  } while (!is_still_there(file_, path_));
  const std::string name = our_name();
  if (::ftruncate(file_.get(), 0) != 0 ||
      !file_.write_all({reinterpret_cast<const std::uint8_t*>(name.data()), name.size()}))
    fail(path_, "write");
}

FolderLock::~FolderLock() { ::unlink(path_.c_str()); }  // while it is held: see is_still_there()

std::optional<std::string> lock_holder(const std::filesystem::path& folder) {
  const Descriptor file(lock_path(folder), O_RDONLY);
  if (!file.is_open()) return std::nullopt;
  struct flock range = whole_file();
  if (::fcntl(file.get(), F_OFD_GETLK, &range) != 0 || range.l_type == F_UNLCK) return std::nullopt;
  return name_in(file);
}

}  // namespace gigabake
