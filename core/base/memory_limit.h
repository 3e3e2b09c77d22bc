/// The limit of the memory that source files can make this process allocate. A file of a few bytes can request
/// gigabytes: an image of one colour, a million placements of one mesh, a grid without values. MemoryClaim checks each
/// size that a file states before the allocation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace gigabake {

/// Sets the limit of the process (a bake's memory_bytes); 0, the initial value, means no limit. Call it before sources
/// are opened.
void set_memory_limit(std::uint64_t bytes);
/// Returns the limit in bytes; UINT64_MAX if there is none.
std::uint64_t memory_limit();

/// Returns a size for messages, for example "3.2 GB".
std::string readable_size(std::uint64_t bytes);

/// The sum of the memory requests of one file or cell.
class MemoryClaim {
 public:
  /// `advice` names the remedy other than raising the limit.
  explicit MemoryClaim(std::filesystem::path file, const char* advice = "split the file")
      : file_(std::move(file)), advice_(advice) {}

  /// Adds a request. `what` names it in the message, for example "20 × 30 texels".
  /// Errors  InputError(file, key) if the sum exceeds memory_limit(). The message states the requested and the allowed
  ///         size, and the field that raises the limit.
  void add(std::uint64_t bytes, std::string_view key, std::string_view what) { add_items(1, bytes, key, what); }
  /// Adds a request for `items` items of `item_bytes` bytes each. A product that overflows counts as UINT64_MAX. `what`
  /// is a plural noun for the message, for example "placements of meshes".
  /// Cost    O(1).
  void add_items(std::uint64_t items, std::uint64_t item_bytes, std::string_view key, std::string_view what);
  /// Subtracts bytes that were added before and have been freed.
  void give_back(std::uint64_t bytes) { bytes_ -= bytes; }

 private:
  [[noreturn]] void fail(std::uint64_t sum, std::uint64_t items, std::string_view key, std::string_view what) const;

  std::filesystem::path file_;
  const char* advice_;
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
