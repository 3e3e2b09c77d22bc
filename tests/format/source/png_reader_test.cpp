/// Compares decoded PNGs of every format with the codes in their bytes. No other decoder is the reference.
#include <cstring>
#include <gtest/gtest.h>
#include <zlib.h>

#include "core/base/error.h"
#include "format/source/image/image_check.h"
#include "format/source/image/image_rows.h"

namespace gigabake {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_word(Bytes& out, std::uint32_t v) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(std::uint8_t(v >> shift));
}

void put_chunk(Bytes& out, const std::string& type, const Bytes& data) {
  put_word(out, std::uint32_t(data.size()));
  Bytes body(type.begin(), type.end());
  body.insert(body.end(), data.begin(), data.end());
  out.insert(out.end(), body.begin(), body.end());
  put_word(out, std::uint32_t(crc32(0, body.data(), unsigned(body.size()))));
}

struct PngKind {
  std::uint32_t width = 0, height = 0;
  std::uint8_t depth = 8, colour = 2;  ///< colour type of the specification
  bool is_interlaced = false;
  std::vector<std::pair<std::string, Bytes>> chunks = {};  ///< between IHDR and IDAT
};

/// Returns a PNG file. Each row of `rows` begins with its filter byte.
EncodedImage png_of(const PngKind& kind, const Bytes& rows) {
  Bytes out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, head;
  put_word(head, kind.width), put_word(head, kind.height);
  head.insert(head.end(), {kind.depth, kind.colour, 0, 0, std::uint8_t(kind.is_interlaced)});
  put_chunk(out, "IHDR", head);
  for (const auto& [type, data] : kind.chunks) put_chunk(out, type, data);
  Bytes packed(compressBound(rows.size()));
  uLongf size = packed.size();
  compress(packed.data(), &size, rows.data(), rows.size());
  packed.resize(size);
  put_chunk(out, "IDAT", packed);
  put_chunk(out, "IEND", {});
  return {"a.png", out};
}

/// Returns the texels of the image. Fails the test if the two readers differ.
Bytes texels_of(const EncodedImage& encoded) {
  const Image whole = decode_image(encoded);
  if (const auto rows = ImageRows::open(encoded)) {
    Bytes by_rows(whole.rgba.size());
    for (std::size_t y = 0; y < std::size_t(whole.height); ++y) rows->next(&by_rows[4 * std::size_t(whole.width) * y]);
    EXPECT_EQ(by_rows, whole.rgba);
  }
  return whole.rgba;
}

/// Returns colour space chunks that a reader must neither use nor refuse: gAMA states linear light, cHRM the primaries
/// of BT.2020. The chunks iCCP and sRGB are invalid.
std::vector<std::pair<std::string, Bytes>> colour_space_chunks() {
  Bytes gamma, primaries;
  put_word(gamma, 100000);
  for (const std::uint32_t v : {31270u, 32900u, 70800u, 29200u, 17000u, 79700u, 13100u, 4600u}) put_word(primaries, v);
  return {{"gAMA", gamma}, {"cHRM", primaries}, {"iCCP", {'x', 0, 0, 1, 2, 3}}, {"sRGB", {9}}};
}

// 2026-11-25: a file with gAMA 100000 turned 200 100 50 into 228 167 122, and so did a 16-bit file without any chunk.
TEST(PngReader, TakesCodesAsSrgbWhateverTheFileSaysOfItsColourSpace) {
  const PngKind plain{2, 1, 8, 2}, managed{2, 1, 8, 2, false, colour_space_chunks()};
  const Bytes rows{0, 200, 100, 50, 0, 128, 255}, expected{200, 100, 50, 255, 0, 128, 255, 255};
  EXPECT_EQ(texels_of(png_of(plain, rows)), expected);
  EXPECT_EQ(texels_of(png_of(managed, rows)), expected);
}

TEST(PngReader, ScalesSixteenBitsToTheNearestOfEight) {
  for (const bool is_managed : {false, true}) {
    PngKind kind{1, 1, 16, 6};
    if (is_managed) kind.chunks = colour_space_chunks();
    // The values are 200 · 257 + 1, 100 · 257 - 128 and 50 · 257 + 129; alpha 32896 is 128 · 257.
    const Bytes rows{0, 0xc8, 0xc9, 0x63, 0xe4, 0x32, 0xb3, 0x80, 0x80};
    EXPECT_EQ(texels_of(png_of(kind, rows)), (Bytes{200, 100, 51, 128}));
  }
}

TEST(PngReader, ExpandsGreyOfEveryDepth) {
  const struct {
    std::uint8_t depth;
    Bytes row;
    std::uint8_t first, second;
  } cases[] = {{1, {0, 0x40}, 0, 255},
               {2, {0, 0x60}, 85, 170},
               {4, {0, 0x3c}, 51, 204},
               {8, {0, 7, 250}, 7, 250},
               {16, {0, 7, 7, 250, 250}, 7, 250}};
  for (const auto& [depth, row, first, second] : cases) {
    PngKind kind{2, 1, depth, 0, false, colour_space_chunks()};
    EXPECT_EQ(texels_of(png_of(kind, row)), (Bytes{first, first, first, 255, second, second, second, 255}))
        << int(depth) << " bits";
  }
}

TEST(PngReader, TakesTransparentPaletteEntriesAndColours) {
  const PngKind palette{2, 1, 8, 3, false, {{"PLTE", {1, 2, 3, 200, 100, 50}}, {"tRNS", {255, 40}}}};
  EXPECT_EQ(texels_of(png_of(palette, {0, 1, 0})), (Bytes{200, 100, 50, 40, 1, 2, 3, 255}));
  const PngKind key{2, 1, 16, 2, false, {{"tRNS", {1, 2, 3, 4, 5, 6}}}};  // transparent only if all 16 bits agree
  EXPECT_EQ(texels_of(png_of(key, {0, 1, 2, 3, 4, 5, 6, 1, 3, 3, 4, 5, 6})), (Bytes{1, 3, 5, 0, 1, 3, 5, 255}));
}

/// Source  PNG, Adam7: of 2 × 2 texels the first is in pass 1, the second in pass 6, the lower row in pass 7.
TEST(PngReader, PutsInterlacedTexelsInTheirPlaces) {
  const PngKind kind{2, 2, 8, 2, true, colour_space_chunks()};
  const Bytes rows{0, 1, 1, 1, 0, 2, 2, 2, 0, 3, 3, 3, 4, 4, 4};
  EXPECT_EQ(texels_of(png_of(kind, rows)), (Bytes{1, 1, 1, 255, 2, 2, 2, 255, 3, 3, 3, 255, 4, 4, 4, 255}));
}

std::string fault_of(const Bytes& bytes) {
  try {
    check_image("a.glb", "images[0]", SourceBytes(bytes));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(CheckImage, FindsWhatIsCutShortAndWhatIsNoImage) {
  Bytes rows;
  for (int i = 0; i < 64 * 193; ++i) rows.push_back(std::uint8_t(i % 193 == 0 ? 0 : i * i * 7));
  const Bytes whole = png_of({64, 64, 8, 2}, rows).bytes;
  EXPECT_EQ(fault_of(whole), "");
  EXPECT_EQ(fault_of({whole.begin(), whole.end() - 12}), "") << "without IEND";
  EXPECT_EQ(fault_of({whole.begin(), whole.end() - 40}), "a.glb: images[0]: the image is cut short");
  EXPECT_EQ(fault_of({}), "a.glb: images[0]: is empty");
  const std::string page = "<html>404 not found</html>";
  EXPECT_NE(fault_of({page.begin(), page.end()}).find("a.glb: images[0]: neither PNG"), std::string::npos);
}

}  // namespace
}  // namespace gigabake
