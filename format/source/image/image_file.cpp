#include "format/source/image/image_file.h"

#include "core/base/error.h"
#include "format/source/image/encoding.h"

namespace gigabake {

bool is_image_file(const SourceFiles& files, const std::filesystem::path& file) {
  constexpr std::size_t head_bytes = 16;
  try {
    encoding_of({file.string(), files.content_head(file, head_bytes)});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace gigabake
