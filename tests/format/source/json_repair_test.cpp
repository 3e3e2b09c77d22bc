#include "format/source/json/json_repair.h"

#include <gtest/gtest.h>
#include <string>
#include <string_view>

namespace gigabake {
namespace {

std::string repaired(std::string_view text) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  return repaired_json(bytes).value_or("unchanged");
}

TEST(RepairedJson, LeavesValidTextAlone) {
  for (const char* text :
       {R"("plain")", R"("\ud83d\ude00 \\ud800 \u00e4 \ud7ff \ue000")", "\"\xc3\xa4\"", "\"\\u", "\\"})
    EXPECT_EQ(repaired(text), "unchanged") << text;
}

/// 2026-11-25: one name with an invalid character made the whole file unreadable.
TEST(RepairedJson, ReplacesLoneSurrogatesAndInvalidBytes) {
  const std::string other = "\xef\xbf\xbd";
  EXPECT_EQ(repaired(R"("a\ud800b")"), R"("a\ufffdb")");
  EXPECT_EQ(repaired(R"("\uDC00")"), R"("\ufffd")");
  EXPECT_EQ(repaired(R"("\ud800\ud83d\ude00")"), R"("\ufffd\ud83d\ude00")");
  EXPECT_EQ(repaired(R"("\\\ud800\u0041")"), R"("\\\ufffd\u0041")");
  EXPECT_EQ(repaired("\"Stra\xdf"
                     "e\""),
            "\"Stra" + other + "e\"");
  EXPECT_EQ(repaired("\"\xed\xa0\x80\""), "\"" + other + other + other + "\"");
  EXPECT_EQ(repaired("\"\xff\\ud800\""), "\"" + other + "\\ufffd\"");
}

}  // namespace
}  // namespace gigabake
