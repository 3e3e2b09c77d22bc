#include <algorithm>
#include <mutex>
#include <zip.h>

#include "core/base/error.h"
#include "format/source/tiles/archive.h"

namespace gigabake {
namespace {

/// Deflate packs at most 1032:1, so an entry with a higher ratio states a false size.
constexpr std::uint64_t max_zip_ratio = 1100, min_checked_bytes = std::uint64_t(1) << 16;

std::string message_of(zip_error_t* error) {
  std::string text = zip_error_strerror(error);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

struct Archive::State {
  mutable std::mutex mutex;
  zip_t* zip = nullptr;
};

Archive::Archive(const std::filesystem::path& file) : file_(file), state_(std::make_unique<State>()) {
  int code = 0;
  state_->zip = zip_open(file.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code);
  if (state_->zip != nullptr) return;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string message = message_of(&error);
  zip_error_fini(&error);
  throw InputError(file, "", "expected a ZIP archive: " + message);
}

Archive::~Archive() { zip_discard(state_->zip); }

std::optional<std::uint64_t> Archive::size_of(const std::string& entry) const {
  const std::scoped_lock lock(state_->mutex);
  zip_stat_t info;
  zip_stat_init(&info);
  if (zip_stat(state_->zip, entry.c_str(), ZIP_FL_ENC_RAW, &info) != 0 || (info.valid & ZIP_STAT_SIZE) == 0) return {};
  return info.size;
}

std::vector<std::uint8_t> Archive::read(const std::string& entry, std::uint64_t max_bytes) const {
  const std::scoped_lock lock(state_->mutex);
  const auto fail = [&](const std::string& message) { throw InputError(file_ / entry, "", message); };
  zip_stat_t info;
  zip_stat_init(&info);
  if (zip_stat(state_->zip, entry.c_str(), ZIP_FL_ENC_RAW, &info) != 0) fail("no such file in the archive");
  if (info.size > min_checked_bytes && info.size / max_zip_ratio > info.comp_size)
    fail("states " + std::to_string(info.size) + " bytes in " + std::to_string(info.comp_size) + " packed bytes");
  std::vector<std::uint8_t> bytes(std::min<std::uint64_t>(info.size, max_bytes));
  zip_file_t* in = zip_fopen_index(state_->zip, info.index, 0);
  if (in == nullptr) fail("cannot be unpacked: " + message_of(zip_get_error(state_->zip)));
  std::uint64_t got = 0;
  zip_int64_t step = 1;
  while (got < bytes.size() && step > 0) {
    step = zip_fread(in, bytes.data() + got, bytes.size() - got);
    got += step > 0 ? std::uint64_t(step) : 0;
  }
  std::uint8_t beyond = 0;
  if (step >= 0 && bytes.size() == info.size) step = zip_fread(in, &beyond, 1);  // a read at the end checks the CRC
  const std::string message = step < 0 ? message_of(zip_file_get_error(in)) : "";
  zip_fclose(in);
  if (step < 0) fail("cannot be unpacked: " + message);
  if (got != bytes.size()) fail("cannot be unpacked to its end");
  return bytes;
}

}  // namespace gigabake
