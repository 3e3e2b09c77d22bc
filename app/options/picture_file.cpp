#include "app/options/picture_file.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/base/error.h"
#include "format/system/publish.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::app {
namespace {

constexpr int jpeg_quality = 92;  // 4:4:4, without chroma subsampling (viewer/pictures/image_files.h)

}  // namespace

PictureFormat picture_format(const char* option, const std::string& name) {
  std::string suffix = std::filesystem::path(name).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (suffix == ".png") return PictureFormat::png;
  if (suffix == ".jpg" || suffix == ".jpeg") return PictureFormat::jpeg;
  if (const auto error = missing_openexr_error(); error && suffix == ".exr")
    throw UsageError(fmt::format("{}: {}", option, *error));
  if (suffix == ".exr") return PictureFormat::exr;
  throw UsageError(fmt::format("{}: expected a name that ends in .png, .jpg, .jpeg or .exr, got '{}'", option, name));
}

void write_picture(const std::string& name, const Picture& picture, double voxel_size_m) {
  switch (picture_format("-o", name)) {
    case PictureFormat::png:
      return write_png(name, picture);
    case PictureFormat::jpeg:
      return publish_file(name, encode_jpeg(picture, jpeg_quality));
    case PictureFormat::exr:
      return write_exr(name, picture, ExrChannels::light_and_depth, voxel_size_m);
  }
}

}  // namespace gigabake::app
