#include "format/system/read_file.h"

#include <fstream>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/work_counts.h"

namespace gigabake {

std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw IoError(path, "", "no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path, "", "expected a regular file");
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) throw IoError(path, "", "cannot be read: " + error.message());
  if (bytes > max_bytes)
    throw InputError(path, "", "larger than " + std::to_string(max_bytes) + " bytes; split it into tiles");
  MemoryClaim(path).add_items(bytes, 1, "", "bytes of the file");
  std::vector<std::uint8_t> content(bytes);
  count_work(WorkCounter::files_opened);
  count_work(WorkCounter::file_bytes_read, bytes);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(content.data()), std::streamsize(bytes)))
    throw IoError(path, "", "cannot be read to its end");
  return content;
}

}  // namespace gigabake
