#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "format/source/mesh.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

Picture gradient(int width, int height) {
  Picture p{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      p.rgba.insert(p.rgba.end(), {std::uint8_t(255 * x / width), std::uint8_t(255 * y / height), 90, 255});
  return p;
}

TEST(Jpeg, LooksLikeThePictureTheMoreTheHigherItsQuality) {
  const Picture picture = gradient(61, 37);
  double last = 255;
  for (const int quality : {20, 75, 95}) {
    const std::string bytes = encode_jpeg(picture, quality);
    const Image image = decode_image({"p.jpg", {bytes.begin(), bytes.end()}});
    ASSERT_EQ(image.width, 61);
    ASSERT_EQ(image.height, 37);
    double sum = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) sum += std::abs(int(picture.rgba[i]) - int(image.rgba[i]));
    EXPECT_LT(sum / double(picture.rgba.size()), std::min(last, 6.0)) << quality;
    last = sum / double(picture.rgba.size());
  }
  EXPECT_LT(last, 1.5);
}

TEST(Jpeg, RefusesAPictureThatIsNone) { EXPECT_THROW(encode_jpeg(Picture{}, 80), std::runtime_error); }

}  // namespace
}  // namespace gigabake
