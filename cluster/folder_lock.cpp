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

/// Whoever held the lock before may have removed the file in the meantime: a lock on it then keeps nobody out.
bool is_still_there(const Descriptor& file, const std::filesystem::path& path) {
  struct stat ours {
  }, there{};
  return ::fstat(file.get(), &ours) == 0 && ::stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

/// All that the holder wrote: its name on the first line, its PID namespace on the second.
std::string text_in(const Descriptor& file) {
  std::array<char, 400> text{};
  const ssize_t bytes = ::pread(file.get(), text.data(), text.size(), 0);
  return {text.data(), std::size_t(std::max<ssize_t>(0, bytes))};
}

/// What the holder wrote, on one line.
std::string name_in(const Descriptor& file) {
  std::string line = text_in(file);
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

/// The line that says in which PID namespace this process has its number; empty without /proc.
std::string namespace_line() {
  std::error_code code;
  const std::filesystem::path name = std::filesystem::read_symlink("/proc/self/ns/pid", code);
  return code ? std::string() : "namespace " + name.string() + "\n";
}

/// Whether the holder is a process of this host that was killed and still ends: what it was writing must reach the disk
/// before the system closes its files, which can take seconds. A process that cannot be seen from here, in another PID
/// namespace or of another user (hidepid), is not taken for one: nothing tells that it ends.
bool is_ending(const std::string& holder) {
  long process = 0;
  std::array<char, 200> host{};
  if (std::sscanf(holder.c_str(), "process %ld on %199s since", &process, host.data()) != 2) return false;
  if (process <= 0 || host.data() != host_name()) return false;
  const std::string own_namespace = namespace_line();
  if (own_namespace.empty() || !holder.ends_with("\n" + own_namespace)) return false;
  const std::filesystem::path entry = "/proc/" + std::to_string(process);
  std::error_code code;
  if (::kill(pid_t(process), 0) != 0 && errno == ESRCH) return true;  // a child of it still has its files
  if (!std::filesystem::exists(entry, code)) return false;
  const auto program = std::filesystem::read_symlink(entry / "exe", code);
  // A process that has given its memory back has no program any more; one of somebody else's does not show it.
  const bool has_given_back = program.empty() && code != std::errc::permission_denied;
  return has_given_back || has_kill_pending(pid_t(process));
}

/// False: somebody has it who goes on, or does not end.
bool lock_after_end(const Descriptor& file) {
  const auto start = std::chrono::steady_clock::now();
  while (!try_lock(file)) {
    if (errno != EAGAIN && errno != EACCES) return false;
    if (std::chrono::steady_clock::now() - start > longest_end || !is_ending(text_in(file))) {
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

/// A folder that a group shares has a lock file that the group may take over, whatever this process's umask.
void share_with_group(const Descriptor& file, const std::filesystem::path& folder) {
  struct stat ours {
  }, there{};
  if (::fstat(file.get(), &ours) != 0 || ::stat(folder.c_str(), &there) != 0) return;
  if (ours.st_uid != ::geteuid() || (there.st_mode & S_IWGRP) == 0) return;
  // Where it fails the others of the group replace the file: see remove_left_file().
  if (::fchown(file.get(), uid_t(-1), there.st_gid) != 0 && ours.st_gid != there.st_gid) return;
  if (::fchmod(file.get(), (ours.st_mode & 0777) | S_IRGRP | S_IWGRP) != 0) return;
}

/// Removes the lock file of another user that may be read only, if nobody holds it. While it is locked for reading
/// nobody can lock it for writing, and a second file lets one process at a time do this.
/// Errors  InputError: somebody holds it.
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

FolderLock::~FolderLock() { ::unlink(path_.c_str()); }  // while it is held: see is_still_there()

std::optional<std::string> lock_holder(const std::filesystem::path& folder) {
  const Descriptor file(lock_path(folder), O_RDONLY);
  if (!file.is_open()) return std::nullopt;
  struct flock range = whole_file();
  if (::fcntl(file.get(), F_OFD_GETLK, &range) != 0 || range.l_type == F_UNLCK) return std::nullopt;
  return name_in(file);
}

}  // namespace gigabake
