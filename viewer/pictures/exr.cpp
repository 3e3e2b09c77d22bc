#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "format/system/publish.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

constexpr const char* light_names[4] = {"R", "G", "B", "A"};

/// An output stream into a string.
class Bytes final : public Imf::OStream {
 public:
  Bytes() : OStream("an image") {}

  void write(const char data[], int size) override {
    const auto count = std::size_t(size);
    if (at_ + count > bytes_.size()) bytes_.resize(at_ + count);
    std::memcpy(bytes_.data() + at_, data, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = std::size_t(at); }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

std::vector<half> halves(const std::vector<float>& linear) {
  std::vector<half> out;
  out.reserve(linear.size());
  for (const float value : linear) out.emplace_back(value);
  return out;
}

std::vector<float> metres(const std::vector<float>& voxels, double voxel_size_m) {
  std::vector<float> out;
  out.reserve(voxels.size());
  for (const float depth : voxels)
    out.push_back(depth == kernels::CastRay::no_depth ? std::numeric_limits<float>::infinity()
                                                      : float(depth * voxel_size_m));
  return out;
}

/// Returns the description of one channel. `first` points to the channel's value in the first pixel; each pixel has
/// `per_pixel` values of type T. OpenEXR requires a pointer to mutable data but does not write to it.
template <class T>
Imf::Slice slice(Imf::PixelType type, const T* first, std::size_t per_pixel, int width) {
  char* base = const_cast<char*>(reinterpret_cast<const char*>(first));
  return {type, base, per_pixel * sizeof(T), per_pixel * sizeof(T) * std::size_t(width)};
}

void check(const Picture& p, bool needs_light) {
  const std::size_t pixels = std::size_t(p.width) * std::size_t(p.height);
  if (pixels == 0 || p.depth.size() != pixels || (needs_light && p.linear.size() != 4 * pixels))
    throw std::runtime_error("cannot make an EXR: the image has no depth or no linear colours");
}

}  // namespace

std::optional<std::string> missing_openexr_error() { return std::nullopt; }

std::string encode_exr(const Picture& picture, ExrChannels channels, double voxel_size_m) {
  const bool has_light = channels == ExrChannels::light_and_depth;
  check(picture, has_light);
  const std::vector<half> light = has_light ? halves(picture.linear) : std::vector<half>();
  const std::vector<float> depth = metres(picture.depth, voxel_size_m);
  Imf::Header header(picture.width, picture.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer pixels;
  for (std::size_t k = 0; has_light && k < 4; ++k) {
    header.channels().insert(light_names[k], Imf::Channel(Imf::HALF));
    pixels.insert(light_names[k], slice(Imf::HALF, light.data() + k, 4, picture.width));
  }
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  pixels.insert("Z", slice(Imf::FLOAT, depth.data(), 1, picture.width));
  Bytes bytes;
  {
    Imf::OutputFile file(bytes, header);  // its destructor writes the line table
    file.setFrameBuffer(pixels);
    file.writePixels(picture.height);
  }
  return bytes.take();
}

void write_exr(const std::filesystem::path& path, const Picture& picture, ExrChannels channels, double voxel_size_m) {
  publish_file(path, encode_exr(picture, channels, voxel_size_m));
}

}  // namespace gigabake
