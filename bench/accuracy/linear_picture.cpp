#include "bench/accuracy/linear_picture.h"

#include <algorithm>

#include "core/math/srgb.h"
#include "kernels/body/tables.h"
#include "viewer/light/sky.h"

namespace gigabake::bench {

LinearPicture to_linear(const Picture& picture) {
  const kernels::Tables tables = kernels::TableStore::host().view();
  LinearPicture out{picture.width, picture.height, {}};
  out.rgba.resize(picture.rgba.size());
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const float alpha = float(picture.rgba[i + 3]) / 255;
    for (std::size_t c = 0; c < 3; ++c)
      out.rgba[i + c] = alpha * float(tables.linear_from_srgb[picture.rgba[i + c]]) / 65535;
    out.rgba[i + 3] = alpha;
  }
  return out;
}

Picture to_srgb(const LinearPicture& picture) {
  Picture out{picture.width, picture.height, {}, {}};
  out.rgba.resize(picture.rgba.size());
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const double alpha = picture.rgba[i + 3];
    for (std::size_t c = 0; c < 3; ++c)
      out.rgba[i + c] = std::uint8_t(255 * srgb_code(alpha > 0 ? picture.rgba[i + c] / alpha : 0) + 0.5);
    out.rgba[i + 3] = std::uint8_t(255 * std::clamp(alpha, 0.0, 1.0) + 0.5);
  }
  return out;
}

LinearPicture on_screen(LinearPicture picture) {
  const kernels::CastTone tone = screen_tone(0);
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const float alpha = picture.alpha(i);
    for (std::size_t k = 0; k < 3 && alpha > 0; ++k)
      picture.rgba[4 * i + k] = alpha * kernels::shown_light(tone, picture.rgba[4 * i + k] / alpha);
  }
  return picture;
}

std::vector<Rgb> over(const LinearPicture& picture, double background) {
  std::vector<Rgb> out(picture.pixels());
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      out[i][c] = picture.rgba[4 * i + c] + (1 - double(picture.alpha(i))) * background;
  return out;
}

double srgb_code(double linear) { return srgb_from_linear(std::clamp(linear, 0.0, 1.0)); }

}  // namespace gigabake::bench
