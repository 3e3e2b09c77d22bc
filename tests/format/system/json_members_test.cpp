#include "format/system/json/json_members.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace gigabake {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::filesystem::path file = "x.json";

/// Returns the message of the InputError that `read` throws for the members of `text`.
template <class Read>
std::string message(const std::string& text, const Read& read, JsonNull null = JsonNull::absent) {
  const json value = json::parse(text);
  try {
    read(JsonMembers(file, value, "a[2]", null));
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

std::string parse_message(const std::string& text) {
  try {
    parse_json_object(file, text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(JsonMembers, ReturnMembersOfTheRequestedType) {
  const json value = json::parse(R"({"i": 9007199254740992, "n": 3, "d": -0.5, "t": "é", "b": true, "rule": "thin",
                                     "xyz": [1, 2.5, -3], "texts": ["a", "b"], "inner": {"k": 7}})");
  const JsonMembers m(file, value);
  EXPECT_EQ(m.get<std::uint64_t>("i"), std::uint64_t(1) << 53);
  EXPECT_EQ(m.get<int>("n"), 3);
  EXPECT_EQ(m.get<double>("n"), 3);
  EXPECT_EQ(m.get<double>("d"), -0.5);
  EXPECT_EQ(m.get<std::string>("t"), "é");
  EXPECT_TRUE(m.get<bool>("b"));
  EXPECT_EQ(m.get<SurfaceRule>("rule"), SurfaceRule::thin);
  EXPECT_EQ(m.number("d", -1, 1), -0.5);
  EXPECT_EQ(m.numbers<3>("xyz"), (std::array<double, 3>{1, 2.5, -3}));
  EXPECT_EQ(m.numbers("xyz", 3), (std::vector<double>{1, 2.5, -3}));
  EXPECT_EQ(m.texts("texts"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(m.members("inner").get<int>("k"), 7);
  EXPECT_EQ(m.members("inner").path_of("k"), "inner.k");
}

TEST(JsonMembers, TreatAbsentMembersAsNone) {
  const json value = json::parse(R"({"null": null})");
  const JsonMembers m(file, value);
  for (const char* key : {"none", "null"}) {
    EXPECT_FALSE(m.has(key)) << key;
    EXPECT_EQ(m.find<double>(key), std::nullopt) << key;
    EXPECT_EQ(m.number(key, 0, 1), std::nullopt) << key;
    EXPECT_EQ(m.numbers<2>(key), std::nullopt) << key;
    EXPECT_TRUE(m.array(key).empty()) << key;
    EXPECT_TRUE(m.object(key).empty()) << key;
    EXPECT_FALSE(m.members(key).members("deeper").has("k")) << key;
  }
  EXPECT_TRUE(m.contains("null"));
  EXPECT_TRUE(m.is_null("null"));
  EXPECT_FALSE(m.is_null("none"));
  EXPECT_THAT(message(R"({"k": null})", [](const JsonMembers& o) { o.find<double>("k"); }, JsonNull::refused),
              HasSubstr("x.json: a[2].k: expected a finite number"));
}

TEST(JsonMembers, NameTheFileTheMemberAndTheExpectedValue) {
  const auto of = [](const char* text, auto read) { return message(text, read); };
  EXPECT_EQ(of("{}", [](const auto& m) { m.template get<double>("k"); }), "x.json: a[2].k: is missing");
  EXPECT_EQ(of("{}", [](const auto& m) { m.template get<double>("k", "seconds"); }),
            "x.json: a[2].k: is missing; expected seconds");
  EXPECT_EQ(of("[]", [](const auto&) {}), "x.json: a[2]: expected a JSON object");
  for (const char* text : {R"({"k": -1})", R"({"k": 1.0})", R"({"k": 9007199254740993})", R"({"k": "1"})"})
    EXPECT_EQ(of(text, [](const auto& m) { m.template find<std::uint64_t>("k"); }),
              "x.json: a[2].k: expected a whole number that is not negative");
  EXPECT_EQ(of(R"({"k": 2147483648})", [](const auto& m) { m.template find<int>("k"); }),
            "x.json: a[2].k: expected a whole number below 2^31");
  EXPECT_EQ(of(R"({"k": 1})", [](const auto& m) { m.template find<bool>("k"); }),
            "x.json: a[2].k: expected true or false");
  EXPECT_EQ(of(R"({"k": 1})", [](const auto& m) { m.template find<std::string>("k"); }),
            "x.json: a[2].k: expected a text");
  EXPECT_EQ(of(R"({"k": "wide"})", [](const auto& m) { m.template find<SurfaceRule>("k"); }),
            "x.json: a[2].k: expected one of area, conservative, thin, got 'wide'");
  EXPECT_EQ(of(R"({"k": 9})", [](const auto& m) { m.number("k", 0, 1); }),
            "x.json: a[2].k: expected a number from 0 to 1");
  for (const char* text : {R"({"k": 7})", R"({"k": [1]})", R"({"k": [1, "2"]})"})
    EXPECT_EQ(of(text, [](const auto& m) { m.template numbers<2>("k"); }),
              "x.json: a[2].k: expected an array of 2 numbers");
  EXPECT_EQ(of(R"({"k": [1, 2]})", [](const auto& m) { m.template numbers<2>("k", 0, 1); }),
            "x.json: a[2].k: expected an array of 2 numbers from 0 to 1");
  EXPECT_EQ(of(R"({"k": {}})", [](const auto& m) { m.array("k"); }), "x.json: a[2].k: expected an array");
  EXPECT_EQ(of(R"({"k": []})", [](const auto& m) { m.members("k"); }), "x.json: a[2].k: expected a JSON object");
  EXPECT_EQ(of(R"({"k": [{}, 3]})", [](const auto& m) { m.list("k", [](const JsonMembers&) { return 0; }); }),
            "x.json: a[2].k[1]: expected a JSON object");
  EXPECT_EQ(of("{}", [](const auto& m) { m.texts("k"); }), "x.json: a[2].k: is missing");
}

TEST(JsonMembers, RefuseUnknownMembers) {
  const auto only = [](const JsonMembers& m) { m.only({"k", "l"}); };
  EXPECT_EQ(message(R"({"k": 1})", only), "none");
  EXPECT_EQ(message(R"({"k": 1, "m": 2})", only), "x.json: a[2]: has an unknown member 'm'; expected k, l");
}

TEST(ParseJsonObject, RefusesRepeatedMembersAndNamesTheirPath) {
  EXPECT_EQ(parse_message(R"({"a": 1, "b": {"a": 2}, "c": [{"a": 3}, {"a": 4}]})"), "none");
  EXPECT_EQ(parse_message(R"({"a": 1, "a": 2})"), "x.json: a: is there twice; keep one of them");
  EXPECT_EQ(parse_message(R"({"c": [{"a": {"x": 1, "y": 2, "x": 3}}]})"),
            "x.json: c.a.x: is there twice; keep one of them");
}

TEST(ParseJsonObject, RefusesWhatIsNoSmallJsonObject) {
  EXPECT_THAT(parse_message("{"), HasSubstr("x.json: not valid JSON (at byte"));
  EXPECT_THAT(parse_message(R"({"a": 1e999})"), HasSubstr("not valid JSON"));
  EXPECT_EQ(parse_message("[]"), "x.json: expected a JSON object");
  EXPECT_THAT(parse_message(std::string(100000, '[')), HasSubstr("nested deeper than 16"));
  EXPECT_EQ(parse_message(R"({"a": )" + std::string(15, '[') + std::string(15, ']') + "}"), "none");
}

}  // namespace
}  // namespace gigabake
