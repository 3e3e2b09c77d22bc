/// Bounds how much of the mapped textures is resident. The pages that cells read from a texture file count as this
/// process's memory until they are released, and a cell may read all of them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <thread>

namespace gigabake {

/// The texture files that this process has mapped. While there are any and memory_limit() is set, a thread looks every
/// few milliseconds how much of files is resident, and releases the pages of all textures above a share of the limit.
/// A released page is mapped again when it is read; the system keeps it as long as it has memory.
/// Thread-safe.
class MappedTextures {
 public:
  static MappedTextures& of_process();

  void add(void* begin, std::uint64_t bytes);
  /// To be called before the mapping ends.
  void remove(void* begin);

 private:
  MappedTextures() = default;
  ~MappedTextures();

  void watch();
  void release_all() const;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<void*, std::uint64_t> mapped_;
  std::uint64_t other_bytes_ = 0;  ///< resident of files before the first texture: program and libraries
  bool ends_ = false;
  std::thread watcher_;
};

/// Returns how many bytes of textures may be resident.
std::uint64_t max_mapped_texture_bytes();

}  // namespace gigabake
