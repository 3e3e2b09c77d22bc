#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <array>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/viewer/ground_scene.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

/// The channels that OpenEXR reads; a channel absent from the file is 0.
struct Exr {
  std::string channels;
  int width = 0, height = 0;
  std::array<std::vector<half>, 4> rgba;
  std::vector<float> z;
};

Exr read_exr(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  Exr out;
  const Imf::ChannelList& channels = file.header().channels();
  for (auto c = channels.begin(); c != channels.end(); ++c) out.channels += c.name();
  const Imath::Box2i window = file.header().dataWindow();
  out.width = window.max.x + 1;
  out.height = window.max.y + 1;
  const std::size_t pixels = std::size_t(out.width) * std::size_t(out.height), width = std::size_t(out.width);
  Imf::FrameBuffer buffer;
  for (std::size_t k = 0; k < 4; ++k) {
    out.rgba[k].resize(pixels);
    buffer.insert(std::string(1, "RGBA"[k]),
                  Imf::Slice(Imf::HALF, reinterpret_cast<char*>(out.rgba[k].data()), 2, 2 * width));
  }
  out.z.resize(pixels);
  buffer.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(out.z.data()), 4, 4 * width));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return out;
}

class ExrTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Exr written(const Picture& picture, ExrChannels channels, double voxel_size_m = 1) const {
    write_exr(folder_ / "p.exr", picture, channels, voxel_size_m);
    return read_exr(folder_ / "p.exr");
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("gigabake_exr_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

/// Renders ground with the given background.
Picture ground_picture(const Background& background, const std::array<double, 3>& eye_m = {-20, -30, 40}) {
  const VoxelScene scene = wide_ground();
  FrameRenderer::Options options;
  options.threads = 2;
  options.memory_bytes = std::uint64_t(1) << 26;
  FrameRenderer renderer(scene.description(), "scene.xml", scene.pages(), options);
  return renderer
      .render_complete({view(eye_m, {64, 64, 12}, 96).camera, ViewMode::lit, background, PictureLight::linear_too})
      .picture;
}

/// Returns the sRGB code of linear light by IEC 61966-2-1, 0 to 255, not rounded.
double code_of_linear(double linear) {
  const double v = std::fmin(linear, 1);
  return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
}

/// Returns the displayed light: light above 0.6 is compressed to below 1 (docs/viewer.md).
double bent(double light) {
  const double over = std::fmax(light - 0.6, 0);
  return light <= 0.6 ? light : 0.6 + 0.4 * over / (over + 0.4);
}

double linear_light(double code) {
  const double part = code / 255;
  return part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
}

/// Returns the displayed value of a pixel with this straight light and alpha. The surface's light is tone-mapped, but
/// the light of a background colour is not.
double shown(double light, double alpha, const Background& background, std::size_t channel) {
  if (background.sky) return bent(light);
  const double behind_alpha = background.rgba[3] / 255.0, through = (1 - alpha) / (1 - behind_alpha);
  const double behind = through * behind_alpha * linear_light(background.rgba[channel]);
  const double surface = std::fmax(1 - through, 1e-9);
  return (surface * bent((light - behind) / surface) + behind) / alpha;
}

TEST_F(ExrTest, HoldsTheLightThatThePngShows) {
  const Exr alone = written(ground_picture({false, {0, 0, 0, 0}}), ExrChannels::light_and_depth);
  for (const Background& background : {Background{}, Background{false, {20, 180, 250, 77}}}) {
    const Picture picture = ground_picture(background);
    const Exr exr = written(picture, ExrChannels::light_and_depth);
    ASSERT_EQ(exr.channels, "ABGRZ");
    ASSERT_EQ(exr.width, 96);
    ASSERT_EQ(exr.height, 96);
    for (std::size_t i = 0; i < exr.z.size(); ++i) {
      const double alpha = exr.rgba[3][i];
      // The tolerances cover the rounding of the PNG and of half floats, which have 11 bits.
      ASSERT_NEAR(255 * alpha, picture.rgba[4 * i + 3], 0.5 + 0.1);
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(code_of_linear(shown(exr.rgba[k][i], alpha, background, k)), picture.rgba[4 * i + k],
                    0.5 + (background.sky && alone.rgba[3][i] < 1 ? 0.7 : 0.2))  // a sky is dithered
            << i << " channel " << k;
    }
  }
}

TEST_F(ExrTest, HoldsTheDistanceOfAPlaneWithinHalfAVoxelAndInfinityBesideIt) {
  const Painter plane = [](std::int64_t, std::int64_t, std::int64_t z) -> std::optional<Paint> {
    if (z != 7) return {};
    return Paint{};
  };
  VoxelScene scene(32);
  scene.add_cells(plane, {0, 0, 0}, 64);
  for (const double height : {30.0, 41.3, 60.9}) {
    PictureOptions options = view({32, 32, height}, {32, 32, 0}, 64);
    options.camera.fovy_deg = 100;
    const Exr exr = written(take(scene, options), ExrChannels::depth, 0.25);
    ASSERT_EQ(exr.channels, "Z");
    const double edge = std::tan(50 * M_PI / 180);
    std::size_t seen = 0, missed = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const double right = edge * ((x + 0.5) / 32 - 1), up = edge * (1 - (y + 0.5) / 32);
        const double down = height - 8;                                        // to the voxels' upper faces
        const double off = std::fmax(std::fabs(right), std::fabs(up)) * down;  // from the middle, on the plane
        const float z = exr.z[std::size_t(64 * y + x)];
        const double stretch = std::hypot(1, right, up);  // length of the ray per voxel of height
        if (off < 30) {
          ASSERT_NEAR(z / 0.25, down * stretch, 0.5 * stretch) << x << "," << y << " from " << height;
        }
        if (off > 34) {
          ASSERT_EQ(z, HUGE_VALF) << x << "," << y << " from " << height;
        }
        seen += off < 30 ? 1 : 0;
        missed += off > 34 ? 1 : 0;
      }
    EXPECT_GT(seen, 400u);
    EXPECT_TRUE(missed > 400u || height < 40);
  }
}

TEST_F(ExrTest, IsTheSameFileForTheSamePicture) {
  const Picture picture = ground_picture({});
  for (const ExrChannels channels : {ExrChannels::light_and_depth, ExrChannels::depth})
    EXPECT_EQ(encode_exr(picture, channels, 0.5), encode_exr(ground_picture({}), channels, 0.5));
  const Exr both = written(picture, ExrChannels::light_and_depth), depth = written(picture, ExrChannels::depth);
  EXPECT_EQ(both.z, depth.z);
}

TEST_F(ExrTest, LeavesNothingBehindWhereItCannotWrite) {
  const Picture picture = ground_picture({});
  EXPECT_THROW(write_exr(folder_ / "missing" / "p.exr", picture, ExrChannels::depth, 1), InputError);
  std::filesystem::create_directory(folder_ / "taken.exr");
  EXPECT_THROW(write_exr(folder_ / "taken.exr", picture, ExrChannels::depth, 1), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(ExrTest, RefusesAPictureWithoutTheLightAskedFor) {
  Picture picture = ground_picture({});
  picture.linear.clear();
  EXPECT_THROW(encode_exr(picture, ExrChannels::light_and_depth, 1), std::runtime_error);
  EXPECT_NO_THROW(encode_exr(picture, ExrChannels::depth, 1));
  EXPECT_THROW(encode_exr(Picture{}, ExrChannels::depth, 1), std::runtime_error);
}

}  // namespace
}  // namespace gigabake
