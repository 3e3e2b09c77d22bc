#include "app/options/flags.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "core/octree/parameters.h"

namespace gigabake::app {
namespace {

TEST(WithFlags, PutsOptionsWhereALibraryHasFields) {
  EXPECT_EQ(with_flags("use a smaller `cell_voxels`"), "use a smaller --cell-voxels");
  EXPECT_EQ(with_flags("`voxel_size_m`: enlarge it or `cell_voxels`"), "--voxel-size: enlarge it or --cell-voxels");
  EXPECT_EQ(with_flags("`to`"), "--to");
}

TEST(WithFlags, LeavesAFilesOwnWordsAlone) {
  for (const char* text : {"", "`", "``", "plain", "Invalid `byteStride' value", "`unknown`", "a`b`c`"})
    EXPECT_EQ(with_flags(text), text);
  EXPECT_EQ(with_flags("Invalid `byteStride': `local`"), "Invalid `byteStride': --local");
}

TEST(Said, NamesTheOptionOfWhatIsOutOfRange) {
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  parameters.max_error = 128;
  try {
    check(parameters);
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_EQ(error_text(error), "--max-error: expected 0 to 127 codes of 255, got 128");
  }
}

}  // namespace
}  // namespace gigabake::app
