#include "format/system/publish.h"

#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <span>
#include <unistd.h>
#include <utility>

#include "format/system/descriptor.h"
#include "format/system/publish_place.h"

namespace gigabake {
namespace {

constexpr int most_attempts = 1000;

void flush_to_disk(const std::filesystem::path& path, int flags) {
  const Descriptor file(path, flags);
  // Some network file systems cannot sync a folder and say EINVAL: the rename is as durable there as it gets.
  if (!file.is_open() || (::fsync(file.get()) != 0 && errno != EINVAL)) fail_to(path, "flush to disk");
}

}  // namespace

Publication::Publication(std::filesystem::path target) : target_(std::move(target)) {
  // A killed process may have left a file of this name: the next number is as good.
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    static std::atomic<unsigned> count{0};
    aside_ = folder_of(target_) / ("." + target_.filename().string() + "." + std::to_string(::getpid()) + "-" +
                                   std::to_string(count++) + ".part");
    const Descriptor file(aside_, O_WRONLY | O_CREAT | O_EXCL);
    if (file.is_open()) return;
    if (errno != EEXIST) break;
  }
  fail_to(target_, "write");
}

Publication::~Publication() {
  if (!published_) ::unlink(aside_.c_str());
}

void Publication::publish(Durability durability) {
  const bool flush = durability == Durability::across_power_loss;
  if (flush) flush_to_disk(aside_, O_RDONLY);
  if (::rename(aside_.c_str(), target_.c_str()) != 0) fail_to(target_, "rename into place");
  published_ = true;
  if (flush) flush_to_disk(folder_of(target_), O_RDONLY | O_DIRECTORY);
}

void publish_file(const std::filesystem::path& target, std::string_view content, Durability durability) {
  Publication file(target);
  {
    const Descriptor out(file.aside(), O_WRONLY | O_TRUNC);
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
    if (!out.is_open() || !out.write_all(bytes)) fail_to(target, "write");
  }
  file.publish(durability);
}

}  // namespace gigabake
