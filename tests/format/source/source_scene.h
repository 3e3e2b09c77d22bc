/// A folder of small source files for one test.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace gigabake::test {

using Json = nlohmann::json;

class SourceFolder {
 public:
  SourceFolder();
  ~SourceFolder();
  SourceFolder(const SourceFolder&) = delete;
  SourceFolder& operator=(const SourceFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const;
  std::filesystem::path write(const std::string& name, const Json& json) const { return write(name, json.dump()); }

 private:
  std::filesystem::path path_;
};

/// Returns glTF with one square of two triangles, (0,0,0) to (1,0,1) in its own y-up axes; buffers are data URIs.
Json square_gltf();

/// Returns a tile of a 3D Tiles tileset with content and children.
Json tile(const std::string& uri, const Json& children = Json::array());
Json tileset(const Json& root);

}  // namespace gigabake::test
