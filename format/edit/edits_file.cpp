#include "format/edit/edits_file.h"

#include <cstdint>
#include <system_error>
#include <vector>

#include "format/system/read_file.h"

namespace gigabake {

std::string read_edits_file(const std::filesystem::path& out) {
  const std::filesystem::path file = edits_file_of(out);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  const std::vector<std::uint8_t> bytes = read_whole_file(file);
  return {bytes.begin(), bytes.end()};
}

SceneEditList edits_of_file(const std::filesystem::path& out, const std::string& text) {
  return text.empty() ? SceneEditList() : scene_edits_from_json(edits_file_of(out), text);
}

}  // namespace gigabake
