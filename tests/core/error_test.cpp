#include "core/base/error.h"

#include <array>
#include <gtest/gtest.h>
#include <random>

#include "core/base/quote.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

// 2026-11-22: a message contained a number of 2·10^8 digits, twice.
TEST(InputError, IsOneShortLineWhateverAFileSays) {
  const std::string digits(200'000, '7'), lines = "a\nb\r\tc\x7f";
  for (const InputError& e :
       {InputError("scene.json", "sources[0].path", digits), InputError(digits, digits, digits),
        InputError("scene.json", digits, "expected a number", 123), InputError(lines, lines, lines, 5)}) {
    const std::string line = e.what();
    EXPECT_LE(line.size(), max_line_bytes);
    EXPECT_EQ(line.find_first_of("\n\r\t\x7f"), std::string::npos) << line;
  }
}

/// 2026-11-22: a message contained 2·10⁸ digits of a file, twice.
TEST(InputError, KeepsTheFileNameBothEndsOfTheKeyAndTheByte) {
  const std::string folder(500, 'f'), key = "root" + std::string(1000, '.') + "uri";
  const std::string line = InputError(folder + "/tile.glb", key, "is missing" + std::string(1000, '!'), 77).what();
  EXPECT_LE(line.size(), max_line_bytes);
  for (const char* part : {"/tile.glb: root", "uri: is missing!", "!! (at byte 77)"})
    EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
}

TEST(InputError, IsWholeWhereItIsShort) {
  EXPECT_STREQ(InputError("a.glb", "nodes[1]", "has a cycle", 9).what(), "a.glb: nodes[1]: has a cycle (at byte 9)");
}

// 2026-11-25: the end of a message, which states the remedy, was cut, while a long path appeared twice.
TEST(InputError, ShortensPathsAndNeverTheCauseOrTheRemedy) {
  const std::string folder = "/data/" + std::string(90, 'f') + "/" + std::string(90, 'g') + "/";
  const std::string cause = "a pixel is 29032 m high, which no place on earth is", remedy = "set 0.3048 for feet";
  const std::string inner = InputError(folder + "dem.tif", "height_scale", cause + "; " + remedy).what();
  for (const std::string& line :
       {inner, std::string(InputError(folder + "scene.json", "", "nothing could be baked: " + inner).what()),
        std::string(InputError("", "", "nothing could be baked: " + inner).what()),
        std::string(UsageError("nothing could be baked: " + folder + "dem.tif: " + cause + "; " + remedy).what())}) {
    EXPECT_LE(line.size(), max_line_bytes);
    for (const std::string& part : {cause, remedy, std::string("dem.tif"), std::string("/data/")})
      EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
  }
}

TEST(InputError, NamesItsFileOnce) {
  const std::string inner = InputError("/a/dem.tif", "crs", "is unknown").what();
  EXPECT_STREQ(InputError("/a/dem.tif", "", inner).what(), "/a/dem.tif: crs: is unknown");
  EXPECT_STREQ(InputError("/a/dem.tif", "dem", "cannot be read: '/a/dem.tif', /a/dem.tif.aux").what(),
               "/a/dem.tif: dem: cannot be read: 'dem.tif', dem.tif.aux");
}

// 2026-11-25: 238 of 444 error messages for files from other programs ended in "…" before the reason.
TEST(InputError, HasAllOfItsOwnWordsWhateverTheLengthOfPathsKeysAndNames) {
  std::string words;  // longer than any message of gigabake
  for (int i = 0; i < 50; ++i) words += "word" + std::to_string(i) + " ";
  words += "end";
  const std::string path = "/data/" + std::string(90, 'f') + " " + std::string(190, 'g') + "/a.glb";
  for (const std::string& name : {std::string(4000, 'n'), std::string(2000, 'n') + " " + std::string(2000, 'm')}) {
    const std::string inner = InputError(path, name, words + in_quotes(name) + "; the remedy").what();
    for (const std::string& line :
         {inner, std::string(InputError("/data/scene.json", name, inner).what()), reason_of(std::runtime_error(inner)),
          std::string(UsageError(words + in_quotes(name) + "; the remedy").what())}) {
      EXPECT_NE(line.find(words), std::string::npos) << line;
      EXPECT_TRUE(line.ends_with("; the remedy")) << line;
      EXPECT_LE(line.size(), max_line_bytes);
    }
  }
}

TEST(ShortPath, KeepsItsFileNameAndIsNotShortenedTwice) {
  const std::string once = short_path("/data/" + std::string(500, 'f') + "/height of the hill.tif");
  EXPECT_EQ(once.size(), max_path_bytes);
  EXPECT_TRUE(once.starts_with("/data/")) << once;
  EXPECT_TRUE(once.ends_with("/height of the hill.tif")) << once;
  EXPECT_EQ(short_path(once), once);
  EXPECT_EQ(with_short_words(once), once);
}

TEST(AsLine, CutsBetweenCharacters) {
  const test::RandomSeed seed;
  std::mt19937 random(seed);
  for (int i = 0; i < 1000; ++i) {
    std::string text;
    while (text.size() < 200) text += std::array{"a", "ü", "–", "🌍"}[random() % 4];
    const std::size_t maximum = 8 + random() % 150;
    const std::string line = as_line(text, maximum), kept = line.substr(0, line.size() - 3);
    ASSERT_LE(line.size(), maximum);
    ASSERT_TRUE(line.ends_with("…"));
    ASSERT_TRUE(text.starts_with(kept));
    ASSERT_NE(static_cast<unsigned char>(text[kept.size()]) & 0xc0, 0x80);
  }
}

TEST(UsageError, IsOneShortLine) {
  EXPECT_LE(std::string(UsageError("--origin: got " + std::string(5000, '1')).what()).size(), max_line_bytes);
  EXPECT_LE(std::string(UsageError("origin", std::string(5000, '1')).what()).size(), max_line_bytes);
}

TEST(UsageError, NamesTheFieldThatIsWrong) {
  const UsageError error("voxel_size_m", "expected 1e-6 to 1e6 metres");
  EXPECT_EQ(error.field(), "voxel_size_m");
  EXPECT_STREQ(error.what(), "`voxel_size_m`: expected 1e-6 to 1e6 metres");
  EXPECT_EQ(UsageError("--local and --origin contradict each other").field(), "");
}

}  // namespace
}  // namespace gigabake
