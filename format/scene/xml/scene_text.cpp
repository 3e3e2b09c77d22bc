#include "format/scene/xml/scene_text.h"

#include <string>

#include "core/base/error.h"
#include "format/system/read_file.h"

namespace gigabake {

SceneText::SceneText(const std::filesystem::path& path, std::uint64_t max_bytes)
    : bytes_(read_whole_file(path, max_bytes)),
      checksum_(checksum_of({reinterpret_cast<const char*>(bytes_.data()), bytes_.size()})) {
  const pugi::xml_parse_result result = document_.load_buffer_inplace(bytes_.data(), bytes_.size());
  if (!result)
    throw InputError(path, "", std::string("not a scene: ") + result.description(), std::uint64_t(result.offset));
}

}  // namespace gigabake
