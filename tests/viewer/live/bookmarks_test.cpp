#include "viewer/live/bookmarks.h"

#include <fstream>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/format/shard/made_shard.h"

namespace gigabake {
namespace {

TEST(Bookmarks, AreGivenBackToTheBitUntilOthersReplaceThem) {
  const made::TempFolder folder;
  const Bookmarks views(folder.path());
  EXPECT_FALSE(views.kept(3, {}));
  const CameraPose first{{0.1, -1e-7, 3e8}, {1.0 / 3, 2, 5}}, second{{1, 2, 3}, {4, 5, 6}};
  views.keep(3, first);
  EXPECT_EQ(Bookmarks(folder.path()).kept(3, {}), first) << "by another window";
  views.keep(3, second);
  EXPECT_EQ(views.kept(3, {}), second);
  EXPECT_FALSE(views.kept(4, {}));
}

TEST(Bookmarks, NameAFileThatIsNone) {
  const made::TempFolder folder;
  const Bookmarks views(folder.path());
  std::ofstream(views.file_of(1)) << "{\"keyframes\": []}";
  EXPECT_THROW(views.kept(1, {}), InputError);
}

TEST(Bookmarks, AreNotKeptWhereNoFolderIs) {
  const made::TempFolder folder;
  EXPECT_ANY_THROW(Bookmarks(folder.path() / "none").keep(1, {{1, 2, 3}, {4, 5, 6}}));
}

}  // namespace
}  // namespace gigabake
