/// How much memory the files of a source may ask this process for. A few bytes can claim gigabytes: an image of one
/// colour, a million placements of one mesh, a grid without values. Every size that a file states is claimed here
/// before anything of that size is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace gigabake {

/// Sets the limit of the whole process, a bake's memory_bytes; 0, as at the start: no bound. To be called before
/// sources are opened.
void set_memory_limit(std::uint64_t bytes);
/// The limit in bytes; UINT64_MAX where there is none.
std::uint64_t memory_limit();

/// "3.2 GB", as people read it.
std::string readable_size(std::uint64_t bytes);

/// What one file, or one cell, asks for, summed up.
class MemoryClaim {
 public:
  /// advice: what a user can do besides raising that limit.
  explicit MemoryClaim(std::filesystem::path file, const char* advice = "split the file")
      : file_(std::move(file)), advice_(advice) {}

  /// what: "20 × 30 texels". Errors  InputError(file, key): the sum is beyond memory_limit(); says how much is wanted,
  /// how much is allowed, and which field raises it.
  void add(std::uint64_t bytes, std::string_view key, std::string_view what) { add_items(1, bytes, key, what); }
  /// `items` of `item_bytes`, whose product may be too large for a number; what: "placements of meshes".
  /// Cost  A comparison, unless it fails.
  void add_items(std::uint64_t items, std::uint64_t item_bytes, std::string_view key, std::string_view what);
  /// Takes back bytes that were added before, because they have been freed.
  void give_back(std::uint64_t bytes) { bytes_ -= bytes; }

 private:
  [[noreturn]] void fail(std::uint64_t sum, std::uint64_t items, std::string_view key, std::string_view what) const;

  std::filesystem::path file_;
  const char* advice_;
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
