#include "format/shard/hdf5/file_image.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace gigabake {
namespace {

/// HDF5 clears unwritten bytes only if it was built to do this. A gap in a file must not show bytes of the previous
/// file.
TEST(FileImage, GivesZerosWhereTheFormerFileStood) {
  FileImage image;
  image.begin_file();
  auto* bytes = static_cast<std::uint8_t*>(image.grow(1000));
  std::fill_n(bytes, 1000, std::uint8_t(7));
  image.begin_file();
  bytes = static_cast<std::uint8_t*>(image.grow(100));
  EXPECT_EQ(std::count(bytes, bytes + 100, 0), 100);
  std::fill_n(bytes, 100, std::uint8_t(9));
  bytes = static_cast<std::uint8_t*>(image.grow(5000));
  EXPECT_EQ(std::count(bytes, bytes + 100, 9), 100) << "the file keeps its bytes";
  EXPECT_EQ(std::count(bytes + 100, bytes + 5000, 0), 4900);
}

TEST(FileImage, SaysWhereNoFileWasMade) {
  FileImage image;
  EXPECT_THROW(image.file(), std::logic_error);
  image.begin_file();
  image.grow(100);
  EXPECT_THROW(image.file(), std::logic_error);
}

}  // namespace
}  // namespace gigabake
