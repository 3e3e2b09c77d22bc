#include "format/source/tiles/tileset_inclusions.h"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace gigabake {
namespace {

std::string name(int i) { return "t" + std::to_string(i) + ".json"; }
std::filesystem::path path(int i) { return "/set/" + name(i); }

// Fixed 2026-11-22: 31 tilesets that name each other twice were followed for a minute.
TEST(TilesetInclusions, RefusesTilesetsThatDoubleAtTheFirstThatIsReadAgain) {
  TilesetInclusions inclusions;
  for (int i = 0; i < 30; ++i) inclusions.read(path(i), {name(i + 1), name(i + 1)});
  inclusions.read(path(30), {"a.glb"});
  EXPECT_THROW(inclusions.read(path(30), {"a.glb"}), InputError);
}

TEST(TilesetInclusions, SeesACycleWithoutFollowingIt) {
  TilesetInclusions inclusions;
  inclusions.read(path(0), {name(1), name(1)});
  inclusions.read(path(1), {name(2), "sub/../" + name(0)});
  inclusions.read(path(2), {});
  EXPECT_THROW(inclusions.read(path(1), {}), InputError);
}

TEST(TilesetInclusions, LetsOneTilesetStandInManyPlaces) {
  TilesetInclusions inclusions;
  inclusions.read(path(0), std::vector<std::string>(100000, name(1)));
  inclusions.read(path(1), {name(2), "a.glb"});
  inclusions.read(path(2), {"b.glb"});
  for (int i = 0; i < 1000; ++i) EXPECT_NO_THROW(inclusions.read(path(1 + i % 2), {}));
}

TEST(TilesetInclusions, CountsWhatIsWrittenDownOften) {
  TilesetInclusions inclusions;
  inclusions.read(path(0), std::vector<std::string>(200000, name(1)));
  inclusions.read(path(1), {name(2)});
  inclusions.read(path(2), {});
  EXPECT_THROW(inclusions.read(path(1), {}), InputError) << "400001 files";
}

}  // namespace
}  // namespace gigabake
