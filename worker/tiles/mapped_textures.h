/// Limit of the resident size of mapped textures. The pages that cells read from a texture file count as this process's
/// memory until they are released. A cell may read all pages of a texture.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <thread>

namespace gigabake {

/// The texture files that this process has mapped. While any is mapped and memory_limit() is set, a thread polls the
/// resident size of mapped files every few milliseconds. Above max_mapped_texture_bytes(), the thread releases the
/// pages of all textures. The next access maps a released page again, without I/O if the page cache still has it.
/// Thread-safe.
class MappedTextures {
 public:
  static MappedTextures& of_process();

  void add(void* begin, std::uint64_t bytes);
  /// Removes a mapping; call it before the mapping ends.
  void remove(void* begin);

 private:
  MappedTextures() = default;
  ~MappedTextures();

  void watch();
  void release_all() const;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<void*, std::uint64_t> mapped_;
  /// Resident bytes of mapped files before the first texture, for example of the program and its libraries.
  std::uint64_t other_bytes_ = 0;
  bool ends_ = false;
  std::thread watcher_;
};

/// Returns the max resident bytes of mapped textures: 1/8 of memory_limit(), at least 16 MiB.
std::uint64_t max_mapped_texture_bytes();

}  // namespace gigabake
