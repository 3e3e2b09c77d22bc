// A pyramid that is built row by row has the same bytes as a pyramid that is built from the whole image. This holds for
// every readable image format. Other formats are refused.
#include "worker/tiles/texture_rows.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <jpeglib.h>
#include <optional>
#include <png.h>
#include <random>

#include "../glb_scene.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/thread_pool.h"
#include "kernels/cpu/texture/texture.h"
#include "worker/tiles/texture_file.h"
#include "worker/tiles/texture_store.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

struct PngKind {
  int type, depth;
  bool has_transparent_colour = false, is_interlaced = false;
  double gamma = 0;
};

/// Returns noise of n columns and m rows.
EncodedImage png_of(const PngKind& kind, png_uint_32 n, png_uint_32 m) {
  EncodedImage out{"image.png", {}};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out.bytes,
      [](png_structp p, png_bytep data, std::size_t size) {
        auto& to = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
        to.insert(to.end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(png, info, n, m, kind.depth, kind.type, kind.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::mt19937 noise(7);
  if (kind.type == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette(std::size_t(1) << kind.depth);
    for (png_color& c : palette) c = {png_byte(noise()), png_byte(noise()), png_byte(noise())};
    png_set_PLTE(png, info, palette.data(), int(palette.size()));
  }
  if (kind.has_transparent_colour) {
    const png_byte alpha[] = {0, 100};
    const png_color_16 colour{0, 1, 1, 1, 1};
    png_set_tRNS(png, info, alpha, 2, &colour);
  }
  if (kind.gamma > 0) png_set_gAMA(png, info, kind.gamma);
  png_write_info(png, info);
  std::vector<std::uint8_t> bytes(png_get_rowbytes(png, info) * m);
  for (std::uint8_t& b : bytes) b = std::uint8_t(noise());
  std::vector<png_bytep> rows;
  for (png_uint_32 y = 0; y < m; ++y) rows.push_back(bytes.data() + y * png_get_rowbytes(png, info));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

EncodedImage jpeg_of(J_COLOR_SPACE space, int components, bool is_progressive, unsigned n, unsigned m) {
  jpeg_compress_struct state{};
  jpeg_error_mgr errors{};
  state.err = jpeg_std_error(&errors);
  jpeg_create_compress(&state);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&state, &bytes, &size);
  state.image_width = n, state.image_height = m;
  state.input_components = components, state.in_color_space = space;
  jpeg_set_defaults(&state);
  if (is_progressive) jpeg_simple_progression(&state);
  jpeg_start_compress(&state, TRUE);
  std::mt19937 noise(7);
  std::vector<std::uint8_t> row(std::size_t(n) * std::size_t(components));
  for (unsigned y = 0; y < m; ++y) {
    for (std::uint8_t& b : row) b = std::uint8_t(noise());
    JSAMPROW at = row.data();
    jpeg_write_scanlines(&state, &at, 1);
  }
  jpeg_finish_compress(&state);
  jpeg_destroy_compress(&state);
  EncodedImage out{"image.jpg", {bytes, bytes + size}};
  std::free(bytes);
  return out;
}

std::vector<std::uint8_t> content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes of a texture file; empty if the image is refused.
using Made = std::vector<std::uint8_t>;

class TextureRowsTest : public testing::Test {
 protected:
  Made whole(const EncodedImage& encoded, const TextureFilterKey& filter_key) const {
    try {
      Image image = decode_image(encoded);
      write_texture(folder.path() / "whole",
                    kernels::Texture(std::move(image.rgba), image.width, image.height, filter_key.alpha,
                                     filter_key.mask_cutoff, callers_thread(), filter_key.content)
                        .view());
      return content(folder.path() / "whole");
    } catch (const InputError&) {
      return {};
    }
  }
  /// Returns nullopt if the image cannot be read in rows.
  std::optional<Made> in_rows(const EncodedImage& encoded, const TextureFilterKey& filter_key) const {
    try {
      const auto rows = ImageRows::open(encoded);
      if (rows == nullptr) return std::nullopt;
      write_texture_rows(folder.path() / "rows", *rows, filter_key);
      return content(folder.path() / "rows");
    } catch (const InputError&) {
      return Made{};
    }
  }

  void expect_same(const EncodedImage& encoded, const std::string& what) const {
    for (const TextureFilterKey& filter_key : recipes) {
      const Made right = whole(encoded, filter_key);
      ASSERT_FALSE(right.empty()) << what;
      const auto made = in_rows(encoded, filter_key);
      ASSERT_TRUE(made.has_value()) << what;
      EXPECT_TRUE(*made == right) << what << ", alpha " << int(filter_key.alpha);
    }
  }

  const std::vector<TextureFilterKey> recipes = {{kernels::TextureAlpha::ignore, 0},
                                                 {kernels::TextureAlpha::blend, 0},
                                                 {kernels::TextureAlpha::mask, 128},
                                                 normal_map_filter};
  ScratchFolder folder;
};

TEST_F(TextureRowsTest, APngOfAnyKindHasTheBytesThatItHasAsAWhole) {
  for (const double gamma : {0.0, 1.0})
    for (const auto& [n, m] : {std::pair(1u, 1u), {37u, 5u}, {64u, 128u}, {7u, 255u}}) {
      std::vector<PngKind> kinds;
      for (const int depth : {1, 2, 4, 8, 16}) {
        kinds.push_back({PNG_COLOR_TYPE_GRAY, depth, false, false, gamma});
        kinds.push_back({PNG_COLOR_TYPE_GRAY, depth, true, false, gamma});
        if (depth <= 8) kinds.push_back({PNG_COLOR_TYPE_PALETTE, depth, false, false, gamma});
        if (depth <= 8) kinds.push_back({PNG_COLOR_TYPE_PALETTE, depth, true, false, gamma});
        if (depth >= 8)
          for (const int type : {PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA})
            kinds.push_back({type, depth, false, false, gamma});
      }
      for (const PngKind& kind : kinds)
        expect_same(png_of(kind, n, m), "type " + std::to_string(kind.type) + ", depth " + std::to_string(kind.depth) +
                                            ", gamma " + std::to_string(gamma) + ", " + std::to_string(n) + " × " +
                                            std::to_string(m));
    }
}

TEST_F(TextureRowsTest, AJpegOfAnyKindHasTheBytesThatItHasAsAWhole) {
  for (const auto& [space, components] : {std::pair(JCS_GRAYSCALE, 1), {JCS_RGB, 3}, {JCS_CMYK, 4}})
    for (const auto& [n, m] : {std::pair(1u, 1u), {37u, 5u}, {64u, 129u}})
      expect_same(jpeg_of(space, components, false, n, m), std::to_string(components) + " components");
}

TEST_F(TextureRowsTest, WhatComesInNoRowsSaysSo) {
  EXPECT_FALSE(in_rows(png_of({PNG_COLOR_TYPE_RGB, 8, false, true}, 20, 20), recipes[0]).has_value());
  EXPECT_FALSE(in_rows(jpeg_of(JCS_RGB, 3, true, 64, 64), recipes[0]).has_value());
}

TEST_F(TextureRowsTest, ADamagedImageIsRefusedWhereItIsRefusedAsAWhole) {
  std::mt19937 random(11);
  std::size_t refused = 0;
  for (const EncodedImage& right : {png_of({PNG_COLOR_TYPE_RGB, 8}, 40, 40), jpeg_of(JCS_RGB, 3, false, 40, 40)})
    for (int i = 0; i < 200; ++i) {
      EncodedImage damaged = right;
      if (i % 2 == 0)
        damaged.bytes.resize(random() % damaged.bytes.size());
      else
        damaged.bytes[random() % damaged.bytes.size()] ^= std::uint8_t(1 << random() % 8);
      const Made whole_bytes = whole(damaged, recipes[1]);
      const auto made = in_rows(damaged, recipes[1]);
      if (made) {
        EXPECT_TRUE(*made == whole_bytes) << damaged.name << ' ' << i;
      }
      refused += whole_bytes.empty();
    }
  EXPECT_GT(refused, 100u);
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_TRUE(entry.path().filename() == "rows" || entry.path().filename() == "whole") << entry.path();
}

/// A low memory limit makes the image count as large. Only some of its rows are then in memory at a time.
TEST_F(TextureRowsTest, AnImageThatDoesNotFitIntoMemoryIsMadeInRowsOrRefusedInOneLine) {
  TextureStore store(folder.path() / "scratch", 1000);
  const TextureKey rows{{1, 1}, recipes[0]}, no_rows{{2, 2}, recipes[0]};
  const EncodedImage plain = png_of({PNG_COLOR_TYPE_RGB, 8}, 200, 200),
                     interlaced = png_of({PNG_COLOR_TYPE_RGB, 8, false, true}, 200, 200);
  set_memory_limit(100'000);
  EXPECT_EQ(store.load(rows, 280'000, [&] { return plain; })->view().width, 200);
  std::string line;
  try {
    store.load(no_rows, 280'000, [&] { return interlaced; });
  } catch (const InputError& e) {
    line = e.what();
  }
  set_memory_limit(0);
  EXPECT_NE(line.find("200 × 200 texels would take"), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_EQ(store.load(no_rows, 280'000, [&] { return interlaced; })->view().height, 200);
}

}  // namespace
}  // namespace gigabake
