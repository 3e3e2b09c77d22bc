/// The text of a scene.xml or of one of its pages, parsed, and its checksum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>
#include <vector>

#include "format/scene/scene_checksum.h"

namespace gigabake {

class SceneText {
 public:
  /// Errors  InputError: no such file, larger than most_bytes, not XML.
  SceneText(const std::filesystem::path& path, std::uint64_t most_bytes);

  const pugi::xml_document& document() const { return document_; }
  const TextChecksum& checksum() const { return checksum_; }

 private:
  std::vector<std::uint8_t> bytes_;  ///< the document stands in them
  pugi::xml_document document_;
  TextChecksum checksum_;
};

}  // namespace gigabake
