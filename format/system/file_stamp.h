/// Identification of a file's content from its metadata, without reading it. Equal stamps mean equal content under the
/// following rules.
///
/// Every write sets the file's change time to the current time. Attempts to hide a write do so too, such as setting
/// mtime back or moving another file into place. No program can set the change time. A file with the stamp that it had
/// when it was read therefore has the same content. The exception is the clock's granularity: a second write within the
/// same tick leaves the same stamp. A stamp is *settled* only if both of its times lie at least 2 s, the coarsest tick
/// of a file system, before the moment at which it was taken. Any later write then changes the stamp. An unsettled
/// stamp is never trusted for a file that others write. (Git calls such a file racily clean.) Take the stamp before
/// reading the file.
///
/// Exact   A stamp has no device number, because hosts of one cluster number the same network file system differently.
/// Range   The clocks of the host and of its file server agree within 2 s minus a tick (10 ms on most systems). File
///         systems without a change time (FAT, some SMB) do not reveal a write of equal size that sets mtime back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace gigabake {

/// The metadata of a file. The default value means that there is no file.
struct FileStamp {
  std::uint64_t size = 0;
  std::int64_t mtime_ns = 0, ctime_ns = 0;
  std::uint64_t inode = 0;
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

/// A file that was read, with its stamp from before reading.
struct StampedFile {
  std::string name;  ///< name used by the reader: relative to the folder of the file that names it
  FileStamp stamp;
  bool settled = false;
};

/// Returns the stamp, FileStamp{} if there is no regular file, or nullopt if the system cannot tell.
/// Cost    Opens the file, because on NFS only an open queries the server; without it, stat may return values that are
///         a minute old. The call takes 2 µs on a local disk.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Returns whether the stamp is settled; true for a missing file. `taken_ns` is a time from before the stamp was taken,
/// in nanoseconds since 1970.
bool is_settled(const FileStamp& stamp, std::int64_t taken_ns);

/// Returns the stamp of `path` under the name `name`; not settled if the system cannot tell.
StampedFile stamped(const std::string& name, const std::filesystem::path& path);

}  // namespace gigabake
