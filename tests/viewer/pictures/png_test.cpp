#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "core/base/error.h"
#include "format/source/mesh.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

class PngTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static Image read_back(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return decode_image({path.string(), {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}});
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("gigabake_png_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

Picture gradient(std::uint8_t alpha) {
  Picture p{5, 3, {}};
  for (int i = 0; i < 15; ++i)
    p.rgba.insert(p.rgba.end(), {std::uint8_t(17 * i), std::uint8_t(255 - 3 * i), std::uint8_t(i), alpha});
  return p;
}

TEST_F(PngTest, KeepsEveryByteWithAndWithoutAlpha) {
  for (const std::uint8_t alpha : {255, 80}) {
    const Picture picture = gradient(alpha);
    write_png(folder_ / "p.png", picture);
    const Image image = read_back(folder_ / "p.png");
    EXPECT_EQ(image.width, 5);
    EXPECT_EQ(image.height, 3);
    EXPECT_EQ(image.rgba, picture.rgba);
    EXPECT_EQ(image.has_alpha, alpha != 255);
  }
}

TEST_F(PngTest, LeavesNothingBehindWhereItCannotWrite) {
  EXPECT_THROW(write_png(folder_ / "missing" / "p.png", gradient(255)), InputError);
  std::filesystem::create_directory(folder_ / "taken.png");
  EXPECT_THROW(write_png(folder_ / "taken.png", gradient(255)), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace gigabake
