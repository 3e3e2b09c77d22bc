/// Inclusions of tilesets in tilesets, counted to refuse excessive ones before they are read. Thirty files that each
/// name the next file twice result in a billion inclusions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gigabake {

class TilesetInclusions {
 public:
  /// Records that a tileset is read; called for every one. file: its canonical path; uris: of all its contents.
  /// Errors  InputError: in the tilesets read until now, the first one includes itself, or more than 2^18 would have to
  ///         be read.
  /// Cost    Visits all recorded tilesets when the first, second, fourth, eighth … tileset is read again.
  void read(const std::filesystem::path& file, const std::vector<std::string>& uris);

 private:
  struct Tileset {
    std::vector<std::string> included;  ///< some may be no tilesets
    double visits = 0;                  ///< of itself and all tilesets below; 0: not counted
    bool is_open = false;
  };
  void expect_few() const;
  double visits_of(const std::string& file, std::map<std::string, Tileset>& tilesets) const;

  std::string first_;
  std::map<std::string, Tileset> tilesets_;  ///< by canonical path
  std::uint64_t again_ = 0;
};

}  // namespace gigabake
