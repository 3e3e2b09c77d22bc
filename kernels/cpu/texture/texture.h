/// A texture, prefiltered in linear light. It owns the mip pyramid that kernels borrow as a TextureView.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/texture/texture_view.h"

namespace gigabake::kernels {

/// The use of the image's alpha channel. The mip pyramid depends on this use, so each use requires a separate Texture.
enum class TextureAlpha : std::uint8_t { ignore, blend, mask };

/// The meaning of a texel's red, green and blue.
enum class TextureContent : std::uint8_t {
  colours,    ///< sRGB codes
  directions  ///< linear codes of a normal map (kernels/body/texture/normal_map.h)
};

int level_count(int width, int height);
/// Returns TextureView::mask_cutoff of a texture with these parameters.
std::uint8_t effective_cutoff(TextureAlpha alpha, std::uint8_t mask_cutoff);

/// Returns an identifier that is unique in the process (TextureView::id).
std::uint64_t new_texture_id();

class Texture {
 public:
  /// Computes the mip pyramid. `rgba` has 4·width·height bytes: red, green, blue and straight alpha.
  /// TextureAlpha::ignore sets alpha to 255. `mask_cutoff` (1 … 255) is used only with TextureAlpha::mask.
  /// Cost    2.7 bytes per texel in addition to the image; one pass over the image.
  Texture(std::vector<std::uint8_t> rgba, int width, int height, TextureAlpha alpha, std::uint8_t mask_cutoff,
          const ThreadPool& pool, TextureContent content = TextureContent::colours);
  TextureView view() const;
  std::size_t bytes() const;

 private:
  std::vector<std::uint8_t> base_;
  std::vector<std::vector<std::uint16_t>> levels_;
  int width_, height_;
  std::uint8_t mask_cutoff_;
  bool is_opaque_;
  std::uint64_t id_;
};

}  // namespace gigabake::kernels
