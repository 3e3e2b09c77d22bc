// The chunks of a GLB are checked before their content.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/source/source.h"
#include "made_glb.h"

namespace gigabake {
namespace {

using testing::HasSubstr;

class GlbChunks : public testing::Test {
 protected:
  GlbChunks() {
    test::MadeGlb made;
    made.add_primitive(made.add(std::vector<float>(9), 3, test::of_floats));
    glb = made.glb();
    std::memcpy(&json_bytes, &glb[12], sizeof json_bytes);
  }
  void put(std::size_t at, std::uint32_t word) { std::memcpy(&glb[at], &word, sizeof word); }
  /// Changes the file's length in bytes, and the length in the header.
  void resize(std::size_t bytes) {
    glb.resize(bytes);
    put(8, std::uint32_t(bytes));
  }
  std::size_t bin_header() const { return 20 + json_bytes; }

  std::string refusal() const {
    const SceneSources sources = open_sources(folder.write("a.glb", glb), {});
    try {
      read_tile(sources.tiles.at(0), sources.root, ReadScope::everything);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }

  test::SourceFolder folder;
  std::string glb;
  std::uint32_t json_bytes = 0;
};

TEST_F(GlbChunks, AreReadAsTheSpecificationHasThem) {
  EXPECT_EQ(refusal(), "was read");
  const std::size_t whole = glb.size();
  resize(whole + 12);  // a third chunk, which is ignored
  put(whole, 4), put(whole + 4, 0x21212121);
  EXPECT_EQ(refusal(), "was read");
}

TEST_F(GlbChunks, TheFirstIsJson) {
  put(16, 0x004e4942);
  EXPECT_THAT(refusal(), HasSubstr("expected the GLB's first chunk to be JSON"));
}

TEST_F(GlbChunks, TheSecondIsBinary) {
  put(bin_header() + 4, 0x21212121);
  EXPECT_THAT(refusal(), HasSubstr("expected the GLB's second chunk to be BIN"));
}

TEST_F(GlbChunks, TheSecondHasAMultipleOfFourBytes) {
  put(bin_header(), 35);
  EXPECT_THAT(refusal(), HasSubstr("expected the GLB's second chunk to have a multiple of 4 bytes, got 35"));
  put(bin_header(), 0);
  EXPECT_THAT(refusal(), HasSubstr("multiple of 4 bytes, got 0"));
}

TEST_F(GlbChunks, EndWithTheFile) {
  put(bin_header(), 40);
  EXPECT_THAT(refusal(), HasSubstr("the file ends inside a GLB chunk"));
  resize(bin_header() + 3);
  EXPECT_THAT(refusal(), HasSubstr("the file ends inside a chunk header"));
  put(8, std::uint32_t(glb.size() + 1));
  EXPECT_THAT(refusal(), HasSubstr("bytes, the file holds"));
}

TEST_F(GlbChunks, AreAsLongAsTheirBuffer) {
  put(bin_header(), 32);
  EXPECT_THAT(refusal(), HasSubstr("buffers[0].byteLength: states 36 bytes, there are 32"));
}

}  // namespace
}  // namespace gigabake
