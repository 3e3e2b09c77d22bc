#include "lattice/error.h"

#include <algorithm>
#include <cctype>
#include <new>
#include <sys/resource.h>
#include <system_error>

namespace gigabake {
namespace {

constexpr std::string_view cut = "…";
constexpr std::size_t longest_path_bytes = 100, shortest_path_bytes = 40, longest_inner_path_bytes = 48;
constexpr std::size_t longest_key_bytes = 70;
/// Longer than any message that the program makes of bounded texts.
constexpr std::size_t longest_own_message_bytes = 600;

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

std::string without_middle(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return std::string(text);
  const std::size_t half = (most_bytes - cut.size()) / 2;
  return std::string(head_of(text, half)).append(cut).append(tail_of(text, half));
}

/// Keeps the folder where a path begins, and more of its end.
std::string short_path(std::string_view path, std::size_t most_bytes) {
  if (path.size() <= most_bytes) return std::string(path);
  const std::size_t head = (most_bytes - cut.size()) / 4;
  return std::string(head_of(path, head)).append(cut).append(tail_of(path, most_bytes - cut.size() - head));
}

/// Shortens each long word with a '/' in it.
std::string with_short_paths(std::string_view text) {
  constexpr std::string_view ends_of_words = " '\"\n\t";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends_of_words, at), text.size());
    const std::string_view word = text.substr(at, end - at);
    out += word.find('/') == word.npos ? std::string(word) : short_path(word, longest_inner_path_bytes);
    if (end < text.size()) out += text[end];
    at = end + 1;
  }
  return out;
}

/// Returns at most `most_bytes` of a message. The cause is in its beginning and the remedy in its end, so paths lose
/// their middle first, then the message does. A flood of text, which only a file writes, loses its end.
std::string fitted(std::string_view message, std::size_t most_bytes) {
  if (message.size() <= most_bytes) return std::string(message);
  const std::string text = with_short_paths(message);
  if (text.size() <= most_bytes) return text;
  if (text.size() > longest_own_message_bytes) return std::string(head_of(text, most_bytes - cut.size())).append(cut);
  const std::size_t head = most_bytes * 2 / 5;
  return std::string(head_of(text, head)).append(cut).append(tail_of(text, most_bytes - cut.size() - head));
}

/// A message that quotes another one of the same file names the file once.
std::string without_path(std::string message, const std::filesystem::path& file) {
  const std::string path = file.string(), name = file.filename().string();
  if (path.size() < 2 || name.empty()) return message;
  for (std::size_t at = 0; (at = message.find(path, at)) != message.npos;) {
    const std::size_t after = at + path.size();
    const bool is_longer = after < message.size() && (message[after] == '/' || std::isalnum(message[after]) != 0);
    const bool is_prefix = message.compare(after, 2, ": ") == 0;
    if (!is_longer) message.replace(at, path.size() + (is_prefix ? 2 : 0), is_prefix ? "" : name);
    at += is_longer ? path.size() : is_prefix ? 0 : name.size();
  }
  return message;
}

std::string message_line(const std::filesystem::path& file, const std::string& key, const std::string& full_message,
                         const std::optional<std::uint64_t>& byte_offset) {
  const std::string place = byte_offset ? " (at byte " + std::to_string(*byte_offset) + ")" : "";
  const std::string message = without_path(full_message, file);
  const auto before_message = [](const std::string& path, const std::string& member) {
    return path + (member.empty() || path.empty() ? "" : ": ") + member + (path.empty() && member.empty() ? "" : ": ");
  };
  const std::string whole = before_message(file.string(), key);
  if (whole.size() + message.size() + place.size() <= longest_message_bytes) return as_line(whole + message + place);
  const std::string member = without_middle(key, longest_key_bytes);
  const std::size_t rest = member.size() + std::min(message.size(), longest_own_message_bytes) + place.size() + 4;
  const std::size_t left = longest_message_bytes - std::min(rest, longest_message_bytes);
  const std::string before =
      before_message(short_path(file.string(), std::clamp(left, shortest_path_bytes, longest_path_bytes)), member);
  return as_line(before) + as_line(fitted(message, longest_message_bytes - before.size() - place.size())) + place;
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
  constexpr std::size_t shortest_message_bytes = 200;  // less is a part of one, such as a name
  std::string line = text.size() <= most_bytes ? std::string(text)
                     : most_bytes >= shortest_message_bytes
                         ? fitted(text, most_bytes)
                         : std::string(head_of(text, most_bytes - cut.size())).append(cut);
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
    : std::runtime_error(message_line(file, key, message, byte_offset)) {}

}  // namespace gigabake
