#include "core/base/memory_limit.h"

#include <array>
#include <atomic>
#include <fmt/format.h>
#include <limits>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

std::atomic<std::uint64_t>& limit_of_process() {
  static std::atomic<std::uint64_t> bytes{no_limit};
  return bytes;
}

}  // namespace

void set_memory_limit(std::uint64_t bytes) { limit_of_process() = bytes == 0 ? no_limit : bytes; }
std::uint64_t memory_limit() { return limit_of_process(); }

std::string readable_size(std::uint64_t bytes) {
  constexpr std::array units{"bytes", "KB", "MB", "GB", "TB", "PB", "EB"};
  if (bytes < 1024) return fmt::format("{} bytes", bytes);
  double size = double(bytes);
  std::size_t unit = 0;
  for (; size >= 1024 && unit + 1 < units.size(); ++unit) size /= 1024;
  return fmt::format("{:.1f} {}", size, units[unit]);
}

void MemoryClaim::add_items(std::uint64_t items, std::uint64_t item_bytes, std::string_view key,
                            std::string_view what) {
  const std::uint64_t bytes = item_bytes != 0 && items > no_limit / item_bytes ? no_limit : items * item_bytes;
  const std::uint64_t sum = bytes > no_limit - bytes_ ? no_limit : bytes_ + bytes;
  if (sum > memory_limit()) fail(sum, items, key, what);
  bytes_ = sum;
}

void MemoryClaim::fail(std::uint64_t sum, std::uint64_t items, std::string_view key, std::string_view what) const {
  const std::uint64_t limit = memory_limit();
  throw InputError(
      file_, std::string(key),
      fmt::format("{}{} would take {} of memory ({} bytes), `memory_bytes` allows {} ({} bytes); raise it, or {}",
                  items == 1 ? "" : std::to_string(items) + " ", what, readable_size(sum), sum, readable_size(limit),
                  limit, advice_));
}

}  // namespace gigabake
