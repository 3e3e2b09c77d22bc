#include "format/system/output_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::size_t buffer_bytes = 1 << 18;

Descriptor opened(const std::filesystem::path& file) {
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  Descriptor out(file, flags);
  if (out.is_open() || errno != ENOENT) return out;
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  return {file, flags};
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path target, const std::filesystem::path& file)
    : target_(std::move(target)), name_(file.filename()), file_(opened(file)) {
  if (!file_.is_open()) fail();
}

void OutputFile::write(std::span<const std::uint8_t> bytes) {
  if (buffer_.size() + bytes.size() > buffer_bytes) flush();
  if (bytes.size() > buffer_bytes) {
    if (!file_.write_all(bytes)) fail();
    return;
  }
  const std::size_t used = buffer_.size();
  buffer_.resize(used + bytes.size());
  if (!bytes.empty()) std::memcpy(buffer_.data() + used, bytes.data(), bytes.size());
}

void OutputFile::finish() {
  flush();
  file_ = Descriptor();
}

void OutputFile::flush() {
  if (!file_.write_all(buffer_)) fail();
  buffer_.clear();
}

void OutputFile::fail() const {
  throw InputError(target_, name_.string(), std::string("cannot write: ") + std::strerror(errno));
}

}  // namespace gigabake
