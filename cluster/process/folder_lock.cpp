#include "cluster/process/folder_lock.h"

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

#include "cluster/mpi/collective.h"
#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::chrono::seconds max_end_wait{30};

std::filesystem::path lock_path(const std::filesystem::path& folder) { return folder / ".lock"; }

struct flock whole_file(short type = F_WRLCK) {
  struct flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  return range;
}

bool try_lock(const Descriptor& file, short type = F_WRLCK) {
  struct flock range = whole_file(type);
  return ::fcntl(file.get(), F_OFD_SETLK, &range) == 0;
}

/// Returns false if a previous owner has removed the file since it was opened: a lock on it would then exclude no
/// process.
bool is_still_there(const Descriptor& file, const std::filesystem::path& path) {
  struct stat ours {
  }, there{};
  return ::fstat(file.get(), &ours) == 0 && ::stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

/// Returns the text that the owner wrote: its name on the first line, its PID namespace on the second.
std::string text_in(const Descriptor& file) {
  std::array<char, 400> text{};
  const ssize_t bytes = ::pread(file.get(), text.data(), text.size(), 0);
  return {text.data(), std::size_t(std::max<ssize_t>(0, bytes))};
}

/// Returns the first line that the owner wrote, without control characters.
std::string name_in(const Descriptor& file) {
  std::string line = text_in(file);
  line.erase(std::min(line.find('\n'), line.size()));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 32) c = '?';
  return line.empty() ? "an unidentified process" : line;
}

/// Returns true if SIGKILL is pending: bit SIGKILL - 1 of the hexadecimal masks in /proc/PID/status.
bool has_kill_pending(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string key, value; status >> key && std::getline(status, value);)
    if ((key == "SigPnd:" || key == "ShdPnd:") && (std::stoull(value, nullptr, 16) >> (SIGKILL - 1) & 1) != 0)
      return true;
  return false;
}

/// Returns the line with the PID namespace in which this process's number is valid; empty without /proc.
std::string namespace_line() {
  std::error_code code;
  const std::filesystem::path name = std::filesystem::read_symlink("/proc/self/ns/pid", code);
  return code ? std::string() : "namespace " + name.string() + "\n";
}

/// Returns true if the owner is a killed process of this host that has not yet ended. Its dirty data must reach the
/// disk before the system closes its files, which can take seconds. Returns false for a process that is not visible, in
/// another PID namespace or of another user (hidepid), because its end cannot be observed.
bool is_ending(const std::string& holder) {
  long process = 0;
  std::array<char, 200> host{};
  if (std::sscanf(holder.c_str(), "process %ld on %199s since", &process, host.data()) != 2) return false;
  if (process <= 0 || host.data() != host_name()) return false;
  const std::string own_namespace = namespace_line();
  if (own_namespace.empty() || !holder.ends_with("\n" + own_namespace)) return false;
  const std::filesystem::path entry = "/proc/" + std::to_string(process);
  std::error_code code;
  if (::kill(pid_t(process), 0) != 0 && errno == ESRCH) return true;  // a child of the owner has the file open
  if (!std::filesystem::exists(entry, code)) return false;
  const auto program = std::filesystem::read_symlink(entry / "exe", code);
  // A process that has released its memory has no program link. The link of another user's process is unreadable.
  const bool has_given_back = program.empty() && code != std::errc::permission_denied;
  return has_given_back || has_kill_pending(pid_t(process));
}

/// Locks the file, after waiting for an owner that is ending. Returns false if the owner continues to run or does not
/// end in time.
bool lock_after_end(const Descriptor& file) {
  const auto start = std::chrono::steady_clock::now();
  while (!try_lock(file)) {
    if (errno != EAGAIN && errno != EACCES) return false;
    if (std::chrono::steady_clock::now() - start > max_end_wait || !is_ending(text_in(file))) {
      errno = EAGAIN;
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

std::string our_name() {
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("process {} on {} since {:%Y-%m-%dT%H:%M:%SZ}\n{}", ::getpid(), host_name(),
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)), namespace_line());
}

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw InputError(path, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

[[noreturn]] void refuse(const std::filesystem::path& folder, const Descriptor& file) {
  throw InputError(folder, "", "is being baked into by " + name_in(file));
}

/// Makes the lock file writable for the group if the folder is, independent of this process's umask, so that the group
/// may reuse the file.
void share_with_group(const Descriptor& file, const std::filesystem::path& folder) {
  struct stat ours {
  }, there{};
  if (::fstat(file.get(), &ours) != 0 || ::stat(folder.c_str(), &there) != 0) return;
  if (ours.st_uid != ::geteuid() || (there.st_mode & S_IWGRP) == 0) return;
  // If this fails, other members of the group replace the file: see remove_left_file().
  if (::fchown(file.get(), uid_t(-1), there.st_gid) != 0 && ours.st_gid != there.st_gid) return;
  if (::fchmod(file.get(), (ours.st_mode & 0777) | S_IRGRP | S_IWGRP) != 0) return;
}

/// Removes another user's read-only lock file if no process has locked it. A read lock on the file excludes writers. A
/// second lock file lets one process at a time do this.
/// Errors  InputError: a process has locked the file.
void remove_left_file(const std::filesystem::path& path) {
  const std::filesystem::path turn_path = path.string() + ".turn";
  Descriptor turn;
  do {
    turn = Descriptor(turn_path, O_RDWR | O_CREAT | O_NOFOLLOW);
    struct flock range = whole_file();
    if (!turn.is_open() || ::fcntl(turn.get(), F_OFD_SETLKW, &range) != 0) return;
  } while (!is_still_there(turn, turn_path));
  const Descriptor left(path, O_RDONLY | O_NOFOLLOW);
  const bool is_held = left.is_open() && !try_lock(left, F_RDLCK);
  if (left.is_open() && !is_held && is_still_there(left, path)) ::unlink(path.c_str());
  ::unlink(turn_path.c_str());
  if (is_held) refuse(path.parent_path(), left);
}

Descriptor open_lock(const std::filesystem::path& path) {
  Descriptor file(path, O_RDWR | O_CREAT | O_NOFOLLOW);
  if (!file.is_open() && errno == EACCES) {
    remove_left_file(path);
    file = Descriptor(path, O_RDWR | O_CREAT | O_NOFOLLOW);
  }
  if (!file.is_open()) fail(path, "open");
  share_with_group(file, path.parent_path());
  return file;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(lock_path(folder)) {
  do {
    file_ = open_lock(path_);
    if (lock_after_end(file_)) continue;
    if (errno != EAGAIN && errno != EACCES) fail(path_, "lock (Lustre needs the mount option flock)");
    refuse(folder, file_);
  } while (!is_still_there(file_, path_));
  const std::string name = our_name();
  if (::ftruncate(file_.get(), 0) != 0 ||
      !file_.write_all({reinterpret_cast<const std::uint8_t*>(name.data()), name.size()}))
    fail(path_, "write");
}

FolderLock::~FolderLock() { ::unlink(path_.c_str()); }  // removed before the lock is released: see is_still_there()

std::optional<std::string> lock_holder(const std::filesystem::path& folder) {
  const Descriptor file(lock_path(folder), O_RDONLY);
  if (!file.is_open()) return std::nullopt;
  struct flock range = whole_file();
  if (::fcntl(file.get(), F_OFD_GETLK, &range) != 0 || range.l_type == F_UNLCK) return std::nullopt;
  return name_in(file);
}

}  // namespace gigabake
