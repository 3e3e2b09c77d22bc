/// The parsed text of a scene.xml or of one of its pages, and its checksum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>
#include <vector>

#include "format/scene/check/scene_checksum.h"

namespace gigabake {

class SceneText {
 public:
  /// Errors  InputError if the file is missing, larger than max_bytes, or not XML.
  SceneText(const std::filesystem::path& path, std::uint64_t max_bytes);

  const pugi::xml_document& document() const { return document_; }
  const TextChecksum& checksum() const { return checksum_; }

 private:
  std::vector<std::uint8_t> bytes_;  ///< backs the document, which was parsed in place
  pugi::xml_document document_;
  TextChecksum checksum_;
};

}  // namespace gigabake
