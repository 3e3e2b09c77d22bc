/// What the system says of a file without anybody reading it: equal stamps mean equal content, under the rules below.
///
/// Every write, and every way to hide one (setting mtime back, moving another file into place), sets the change time of
/// the file to now, and nobody can set that one. So a file with the stamp that it had when it was read still holds what
/// was read, except within the clock's granularity: a write in the same tick as an earlier one leaves the same stamp.
/// Therefore a stamp is *settled* only where both times lie at least 2 s (the coarsest tick of a file system) before
/// the moment at which it was taken: whatever was written after that moment shows. An unsettled stamp is never trusted
/// for a file that others write. (Git calls such a file racily clean.) Take the stamp before the file is read.
///
/// Range   The clocks of the host and of its file server agree within the 2 s less a tick (10 ms on most systems). File
///         systems without a change time (FAT, some SMB) show no write of equal size that sets mtime back.
/// Exact   No device number: hosts of one cluster number the same network file system differently.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace gigabake {

/// Default: of no file.
struct FileStamp {
  std::uint64_t size = 0;
  std::int64_t mtime_ns = 0, ctime_ns = 0;
  std::uint64_t inode = 0;
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

/// A file that was read, as it was before.
struct StampedFile {
  std::string name;  ///< as the reader looked it up: relative to the folder of the file that names it
  FileStamp stamp;
  bool settled = false;
};

/// FileStamp{} where no regular file is; nothing where the system cannot tell.
/// Cost  Opens the file: on NFS only that asks the server, a bare stat may answer from a minute ago. 2 µs on a local
/// disk.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// taken_ns: nanoseconds since 1970, read before the stamp was taken. What is not there is settled.
bool is_settled(const FileStamp& stamp, std::int64_t taken_ns);

/// The stamp of `path`, known as `name`; not settled where the system cannot tell.
StampedFile stamped(const std::string& name, const std::filesystem::path& path);

}  // namespace gigabake
