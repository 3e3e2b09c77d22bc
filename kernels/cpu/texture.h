/// A texture, prefiltered in linear light: owns the pyramid that bodies borrow as a TextureView.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/body/texture_view.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// What a material makes of the image's alpha channel: it decides the pyramid, so each use has its own Texture.
enum class TextureAlpha : std::uint8_t { ignore, blend, mask };

int level_count(int width, int height);
/// TextureView::mask_cutoff of a texture that is made so.
std::uint8_t effective_cutoff(TextureAlpha alpha, std::uint8_t mask_cutoff);

/// Never given twice by a process (TextureView::id).
std::uint64_t new_texture_id();

class Texture {
 public:
  /// rgba: 4·width·height bytes, sRGB colour, straight alpha; TextureAlpha::ignore sets alpha to 255.
  /// mask_cutoff: for TextureAlpha::mask, 1 … 255; otherwise unused.
  /// Cost  2.7 bytes a texel besides the image, one pass over it.
  Texture(std::vector<std::uint8_t> rgba, int width, int height, TextureAlpha alpha, std::uint8_t mask_cutoff,
          const ThreadPool& pool);
  TextureView view() const;
  std::size_t bytes() const;

 private:
  std::vector<std::uint8_t> base_;
  std::vector<std::vector<std::uint16_t>> levels_;
  int width_, height_;
  std::uint8_t mask_cutoff_;
  std::uint64_t id_;
};

}  // namespace gigabake::kernels
