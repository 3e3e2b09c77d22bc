#include "format/source/source_files.h"

#include <algorithm>
#include <fstream>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/content/content_magic.h"
#include "format/source/content/gzip.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_file_bytes = std::uint64_t(1) << 32;
/// Bytes at the beginning of a gzip file that are enough to unpack its first bytes. The gzip header may contain a file
/// name.
constexpr std::size_t gzip_head_bytes = 1024;

}  // namespace

bool SourceFiles::has(const std::filesystem::path& file) const {
  if (archive_) return archive_->size_of(name_in(root_, file)).has_value();
  std::error_code error;
  return std::filesystem::is_regular_file(file, error);
}

std::uint64_t SourceFiles::size_of(const std::filesystem::path& file) const {
  if (archive_) return archive_->size_of(name_in(root_, file)).value_or(0);
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  return error ? 0 : bytes;
}

std::vector<std::uint8_t> SourceFiles::read(const std::filesystem::path& file) const {
  if (!archive_) return read_whole_file(file, max_file_bytes);
  const std::string entry = name_in(root_, file);
  if (archive_->size_of(entry).value_or(0) > max_file_bytes)
    throw InputError(file, "", "larger than 4 GiB; split it into tiles");
  MemoryClaim(file).add_items(archive_->size_of(entry).value_or(0), 1, "", "bytes of the file");
  return archive_->read(entry, max_file_bytes);
}

std::vector<std::uint8_t> SourceFiles::read_content(const std::filesystem::path& file) const {
  std::vector<std::uint8_t> bytes = read(file);
  return is_gzip(bytes) ? unpacked_gzip(file, bytes, std::min(max_file_bytes, memory_limit())) : bytes;
}

SourceBytes SourceFiles::open(const std::filesystem::path& file) const {
  if (archive_) return SourceBytes(read(file));
  return SourceBytes(std::make_shared<const ReadableFile>(file));
}

SourceBytes SourceFiles::open_content(const std::filesystem::path& file) const {
  if (!archive_) {
    const SourceBytes bytes = open(file);
    std::vector<std::uint8_t> buffer;
    if (bytes.size() <= max_file_bytes &&
        content_magic(bytes.look(0, std::min<std::uint64_t>(bytes.size(), 4), buffer)) == ContentMagic::glb)
      return bytes;
  }
  return SourceBytes(read_content(file));
}

std::vector<std::uint8_t> SourceFiles::read_referenced(const std::filesystem::path& file) const {
  std::vector<std::uint8_t> bytes = read(file);
  if (!is_gzip(bytes)) return bytes;
  try {
    return unpacked_gzip(file, bytes, std::min(max_file_bytes, memory_limit()));
  } catch (const InputError&) {
    return bytes;
  }
}

std::vector<std::uint8_t> SourceFiles::content_head(const std::filesystem::path& file, std::size_t max_bytes) const {
  if (!has(file)) return {};
  std::vector<std::uint8_t> head;
  if (archive_) {
    head = archive_->read(name_in(root_, file), gzip_head_bytes);
  } else {
    head.resize(gzip_head_bytes);
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
    head.resize(std::size_t(in.gcount()));
  }
  if (is_gzip(head)) return unpacked_gzip_head(head, max_bytes);
  head.resize(std::min(head.size(), max_bytes));
  return head;
}

StampedFile SourceFiles::stamp(const std::string& name, const std::filesystem::path& file) const {
  if (!archive_) return stamped(name, file);
  const std::filesystem::path whole = std::filesystem::absolute(archive_->file());
  return stamped(whole.string(), whole);
}

}  // namespace gigabake
