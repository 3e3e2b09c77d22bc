#include "format/source/loss_reason.h"

#include <string_view>

namespace gigabake {

std::string reason_without_place(const std::string& error, const std::filesystem::path& file, const std::string& key) {
  std::string_view reason = error;
  const std::string name = file.filename().string() + ": ";
  const std::size_t at = reason.find(name);
  const bool is_in_front = at != reason.npos && (at == 0 || reason[at - 1] == '/') && reason.find(": ") > at;
  if (is_in_front) reason.remove_prefix(at + name.size());
  if (!key.empty() && reason.starts_with(key + ": ")) reason.remove_prefix(key.size() + 2);
  return std::string(reason);
}

}  // namespace gigabake
