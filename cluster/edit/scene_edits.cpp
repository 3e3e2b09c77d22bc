#include "cluster/edit/scene_edits.h"

#include <system_error>

#include "core/base/error.h"
#include "format/system/publish.h"

namespace gigabake {

void write_edits_file(const std::filesystem::path& out, const std::string& text) {
  if (!text.empty()) return publish_file(edits_file_of(out), text);
  std::error_code error;
  std::filesystem::remove(edits_file_of(out), error);
  if (error) throw InputError(edits_file_of(out), "", "cannot be removed: " + error.message());
}

}  // namespace gigabake
