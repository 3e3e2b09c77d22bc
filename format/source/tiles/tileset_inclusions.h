/// Which tilesets include which, so that those that include each other too often are refused before they are followed:
/// thirty files that name the next one twice are a billion.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gigabake {

class TilesetInclusions {
 public:
  /// To be called whenever a tileset is read. file: its canonical path; uris: of all its contents.
  /// Errors  InputError: with what is known so far, the first tileset includes itself somewhere below, or so many that
  ///         more than 2^18 would have to be read.
  /// Cost    Looks at all that is known when the first, second, fourth, eighth … tileset is read again.
  void read(const std::filesystem::path& file, const std::vector<std::string>& uris);

 private:
  struct Tileset {
    std::vector<std::string> included;  ///< may also be no tilesets
    double visits = 0;                  ///< of itself and all below; 0: not counted
    bool is_open = false;
  };
  void expect_few() const;
  double visits_of(const std::string& file, std::map<std::string, Tileset>& tilesets) const;

  std::string first_;
  std::map<std::string, Tileset> tilesets_;  ///< by canonical path
  std::uint64_t again_ = 0;
};

}  // namespace gigabake
