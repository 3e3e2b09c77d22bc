#include "core/base/error.h"

#include <algorithm>
#include <cctype>
#include <new>
#include <sys/resource.h>
#include <system_error>

#include "core/base/quote.h"

namespace gigabake {
namespace {

constexpr std::size_t min_path_bytes = 40, max_key_bytes = 90;

/// Returns the message without the middle of each word that is longer than max_path_bytes. The program's own words are
/// shorter. If a file's text makes the result longer than max_line_bytes, the middle of the result is left out too.
std::string fitted(std::string_view message) { return short_text(with_short_words(message), max_line_bytes); }

std::string without_control_characters(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return text;
}

/// Removes the file's path from a message that quotes another message about the same file.
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
  // A library may print the file's name without its folder.
  if (const std::size_t at = message.find(": " + name + ": "); at != message.npos) message.erase(at, name.size() + 2);
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
  if (whole.size() + message.size() + place.size() <= max_message_bytes)
    return without_control_characters(whole + message + place);
  const std::string member = short_text(key, max_key_bytes), text = fitted(message);
  const std::size_t rest = member.size() + text.size() + place.size() + 4;
  const std::size_t left = max_message_bytes - std::min(rest, max_message_bytes);
  const std::string path = short_path(file.string(), std::clamp(left, min_path_bytes, max_path_bytes));
  return without_control_characters(short_text(before_message(path, member) + text + place, max_line_bytes));
}

/// Returns the message for errno EAGAIN, which only the start of a thread or process causes.
std::string no_more_processes() {
  rlimit limit{};
  const bool is_known = ::getrlimit(RLIMIT_NPROC, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return "the system cannot start more threads and processes; raise the limit (ulimit -u" +
         (is_known ? ", which is " + std::to_string(limit.rlim_cur) : std::string()) +
         ", or the container's pids.max), or use fewer threads";
}

}  // namespace

std::string as_line(std::string_view text, std::size_t max_bytes) {
  constexpr std::size_t min_message_bytes = 200;  // callers use a smaller limit for a part of a message, such as a name
  if (text.size() <= max_bytes) return without_control_characters(std::string(text));
  if (max_bytes >= min_message_bytes) return without_control_characters(fitted(text));
  return without_control_characters(std::string(head_of(text, max_bytes - 3)).append("…"));
}

std::string in_quotes(std::string_view text) { return "'" + as_line(short_text(text, max_quote_bytes)) + "'"; }

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
