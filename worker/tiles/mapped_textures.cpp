#include "worker/tiles/mapped_textures.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <sys/mman.h>
#include <unistd.h>

#include "core/base/memory_limit.h"

namespace gigabake {
namespace {

/// Min limit in bytes: the texels of a few rows of a wide image. A smaller limit would page these rows in repeatedly.
constexpr std::uint64_t min_bytes = std::uint64_t(16) << 20;
constexpr std::chrono::milliseconds interval{4};

/// Returns the resident bytes of mapped files; 0 if the system does not report them.
std::uint64_t resident_file_bytes() {
  unsigned long long all = 0, resident = 0, of_files = 0;
  std::FILE* statm = std::fopen("/proc/self/statm", "re");
  if (statm == nullptr) return 0;
  const int fields = std::fscanf(statm, "%llu %llu %llu", &all, &resident, &of_files);
  std::fclose(statm);
  return fields == 3 ? std::uint64_t(of_files) * std::uint64_t(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace

std::uint64_t max_mapped_texture_bytes() { return std::max(min_bytes, memory_limit() / 8); }

MappedTextures& MappedTextures::of_process() {
  static MappedTextures textures;
  return textures;
}

MappedTextures::~MappedTextures() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  if (watcher_.joinable()) watcher_.join();
}

void MappedTextures::add(void* begin, std::uint64_t bytes) {
  if (memory_limit() == std::numeric_limits<std::uint64_t>::max()) return;
  {
    const std::scoped_lock lock(mutex_);
    if (!watcher_.joinable()) {
      other_bytes_ = resident_file_bytes();
      watcher_ = std::thread([this] { watch(); });
    }
    mapped_.emplace(begin, bytes);
  }
  changed_.notify_all();
}

void MappedTextures::remove(void* begin) {
  const std::scoped_lock lock(mutex_);
  mapped_.erase(begin);
}

void MappedTextures::watch() {
  std::unique_lock lock(mutex_);
  while (!ends_) {
    changed_.wait(lock, [this] { return ends_ || !mapped_.empty(); });
    if (resident_file_bytes() > other_bytes_ + max_mapped_texture_bytes()) release_all();
    changed_.wait_for(lock, interval, [this] { return ends_; });
  }
}

void MappedTextures::release_all() const {
  for (const auto& [begin, bytes] : mapped_) ::madvise(begin, bytes, MADV_DONTNEED);
}

}  // namespace gigabake
