#include "format/system/readable_file.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>
#include <vector>

#include "core/base/error.h"
#include "tests/format/source/source_scene.h"

namespace gigabake {
namespace {

using testing::HasSubstr;

std::string refusal(const std::filesystem::path& path) {
  try {
    ReadableFile file(path);
  } catch (const InputError& e) {
    return e.what();
  }
  return "was opened";
}

std::string text_at(const ReadableFile& file, std::uint64_t offset, std::size_t bytes) {
  std::vector<std::uint8_t> out(bytes);
  file.read(offset, out);
  return {out.begin(), out.end()};
}

TEST(ReadableFile, ReadsAnyRange) {
  const test::SourceFolder folder;
  const ReadableFile file(folder.write("a", std::string("0123456789")));
  EXPECT_EQ(file.bytes(), 10u);
  EXPECT_EQ(text_at(file, 7, 3), "789");
  EXPECT_EQ(text_at(file, 0, 4), "0123");
  EXPECT_EQ(text_at(file, 10, 0), "");
}

TEST(ReadableFile, OfAnotherKindOrNoneIsALineThatSaysSo) {
  const test::SourceFolder folder;
  EXPECT_THAT(refusal(folder.path() / "none"), HasSubstr("none: no such file"));
  EXPECT_THAT(refusal(folder.path()), HasSubstr("expected a regular file"));
  const std::filesystem::path pipe = folder.path() / "pipe";  // has no writer
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(refusal(pipe), HasSubstr("expected a regular file"));
}

/// A failed read does not mean invalid input, because another attempt may succeed.
TEST(ReadableFile, CutAfterItWasOpenedIsALineThatSaysSo) {
  const test::SourceFolder folder;
  const std::filesystem::path path = folder.write("a", std::string(1000, 'a'));
  const ReadableFile file(path);
  std::filesystem::resize_file(path, 10);
  try {
    text_at(file, 5, 100);
    FAIL();
  } catch (const IoError& e) {
    EXPECT_THAT(e.what(), HasSubstr("a: became shorter while it was read (at byte 10)"));
  }
}

}  // namespace
}  // namespace gigabake
