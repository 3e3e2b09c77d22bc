#include "format/system/message.h"

#include <atomic>
#include <chrono>
#include <fmt/chrono.h>
#include <string>

namespace gigabake {
namespace {

constexpr int no_rank = -1;
std::atomic<int> rank_of_lines{no_rank};

std::string with_time(std::string_view lines, int rank) {
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  const std::string start =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ} rank {}: ", fmt::gmtime(std::chrono::system_clock::to_time_t(now)), rank);
  std::string text;
  for (std::size_t at = 0; at < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', at), lines.size() - 1) + 1;
    text.append(start).append(lines.substr(at, end - at));
    at = end;
  }
  return text;
}

}  // namespace

void write_message(std::string_view lines) {
  const int rank = rank_of_lines;
  if (rank == no_rank) return write_part(stderr, lines);
  write_part(stderr, with_time(lines, rank));
}

void write_part(std::FILE* stream, std::string_view text) {
  // Drops text that cannot be written; std::ferror() of the stream remembers the failure.
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size()) return;
}

MessageTime::MessageTime(int rank) { rank_of_lines = rank; }
MessageTime::~MessageTime() { rank_of_lines = no_rank; }

}  // namespace gigabake
