#include "lattice/error.h"

#include <algorithm>
#include <new>
#include <sys/resource.h>
#include <system_error>

namespace gigabake {
namespace {

constexpr std::string_view cut = "…";
constexpr std::size_t longest_path_bytes = 100, longest_key_bytes = 70;

bool is_inside_character(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

/// Whole UTF-8 characters from the beginning, at most `most_bytes`.
std::string_view head_of(std::string_view text, std::size_t most_bytes) {
  std::size_t end = std::min(text.size(), most_bytes);
  while (end > 0 && is_inside_character(text, end)) --end;
  return text.substr(0, end);
}

std::string_view tail_of(std::string_view text, std::size_t most_bytes) {
  std::size_t begin = text.size() - std::min(text.size(), most_bytes);
  while (is_inside_character(text, begin)) ++begin;
  return text.substr(begin);
}

std::string without_beginning(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return std::string(text);
  return std::string(cut).append(tail_of(text, most_bytes - cut.size()));
}

std::string without_middle(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return std::string(text);
  const std::size_t half = (most_bytes - cut.size()) / 2;
  return std::string(head_of(text, half)).append(cut).append(tail_of(text, half));
}

std::string message_line(const std::string& file, const std::string& key, const std::string& message,
                         const std::optional<std::uint64_t>& byte_offset) {
  const std::string place = byte_offset ? " (at byte " + std::to_string(*byte_offset) + ")" : "";
  const auto before_message = [](const std::string& path, const std::string& member) {
    return path + (member.empty() ? "" : ": " + member) + ": ";
  };
  const std::string whole = before_message(file, key);
  if (whole.size() + message.size() + place.size() <= longest_message_bytes) return as_line(whole + message + place);
  const std::string before =
      before_message(without_beginning(file, longest_path_bytes), without_middle(key, longest_key_bytes));
  return as_line(before) + as_line(message, longest_message_bytes - before.size() - place.size()) + place;
}

/// Starting a thread or a process fails in this way alone.
std::string no_more_processes() {
  rlimit limit{};
  const bool is_known = ::getrlimit(RLIMIT_NPROC, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return "the system starts no more threads and processes; raise the limit (ulimit -u" +
         (is_known ? ", which is " + std::to_string(limit.rlim_cur) : std::string()) +
         ", or the container's pids.max), or take fewer threads";
}

}  // namespace

std::string as_line(std::string_view text, std::size_t most_bytes) {
  std::string line =
      text.size() <= most_bytes ? std::string(text) : std::string(head_of(text, most_bytes - cut.size())).append(cut);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return line;
}

std::string in_quotes(std::string_view text) { return "'" + as_line(text, longest_quote_bytes) + "'"; }

std::string reason_of(const std::exception& error) {
  const auto* of_system = dynamic_cast<const std::system_error*>(&error);
  if (of_system != nullptr && of_system->code() == std::errc::resource_unavailable_try_again)
    return no_more_processes();
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                         dynamic_cast<const std::length_error*>(&error) != nullptr;
  return is_memory ? not_enough_memory : as_line(error.what());
}

InputError::InputError(const std::filesystem::path& file, const std::string& key, const std::string& message,
                       std::optional<std::uint64_t> byte_offset)
    : std::runtime_error(message_line(file.string(), key, message, byte_offset)) {}

}  // namespace gigabake
