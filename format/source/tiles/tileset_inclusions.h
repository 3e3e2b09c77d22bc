/// A counter of inclusions of tilesets in tilesets. It refuses an excessive number of inclusions before the tilesets
/// are read. Thirty files that each name the next file twice result in a billion inclusions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gigabake {

class TilesetInclusions {
 public:
  /// Records that a tileset is read. Must be called for every tileset that is read. `file` is the canonical path of the
  /// tileset; `uris` are the URIs of all its contents.
  /// Errors  InputError: a recorded tileset includes itself, or the recorded inclusions would require more than 2^18
  ///         readings of tilesets.
  /// Cost    Counts the inclusions in all recorded tilesets only at the first, second, fourth, eighth … repeated
  ///         reading.
  void read(const std::filesystem::path& file, const std::vector<std::string>& uris);

 private:
  struct Tileset {
    std::vector<std::string> included;  ///< paths of files that may be tilesets
    double visits = 0;                  ///< readings of it and of all tilesets below; 0: not counted yet
    bool is_open = false;
  };
  void expect_few() const;
  double visits_of(const std::string& file, std::map<std::string, Tileset>& tilesets) const;

  std::string first_;
  std::map<std::string, Tileset> tilesets_;  ///< by canonical path
  std::uint64_t again_ = 0;
};

}  // namespace gigabake
