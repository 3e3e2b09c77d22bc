#include "core/base/rules.h"

#include <gtest/gtest.h>

#include "core/io/bytes.h"
#include "core/math/frames.h"

namespace gigabake {
namespace {

template <class Enum>
class Named : public testing::Test {};
using NamedEnums = testing::Types<SurfaceRule, MipFilter, AlphaMode, Codec, UpAxis>;
TYPED_TEST_SUITE(Named, NamedEnums);

TYPED_TEST(Named, ValuesComeBackFromTheirNamesAndNumbers) {
  for (const TypeParam value : values_of<TypeParam>()) {
    EXPECT_EQ(value_named<TypeParam>(name_of(value)), value);
    EXPECT_EQ(value_numbered<TypeParam>(std::uint64_t(value)), value);
    EXPECT_NE(all_names<TypeParam>().find(name_of(value)), std::string::npos);
  }
}

TYPED_TEST(Named, OtherNamesAndNumbersAreNoValue) {
  constexpr std::size_t values = names_of<TypeParam>().size();
  EXPECT_FALSE(value_named<TypeParam>(""));
  EXPECT_FALSE(value_named<TypeParam>("unknown"));
  EXPECT_FALSE(value_named<TypeParam>(std::string(name_of(TypeParam(0))) + " "));
  EXPECT_FALSE(value_numbered<TypeParam>(values));
  EXPECT_FALSE(value_numbered<TypeParam>(UINT64_MAX));
  EXPECT_EQ(name_of(TypeParam(values)), "unknown");
}

TYPED_TEST(Named, BytesOfNoValueAreAnErrorThatNamesThem) {
  ByteWriter writer;
  writer.put(std::uint8_t(200));
  const std::vector<std::uint8_t> bytes = writer.take();
  ByteReader reader(bytes, "made bytes");
  TypeParam value{};
  try {
    reader.get(value);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("200"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(all_names<TypeParam>()), std::string::npos) << error.what();
  }
}

TEST(ByteReader, TakesNothingElseThan0And1ForATruth) {
  for (const int byte : {0, 1, 2, 255}) {
    const std::vector<std::uint8_t> bytes{std::uint8_t(byte)};
    ByteReader reader(bytes, "made bytes");
    bool value = false;
    if (byte <= 1) {
      reader.get(value);
      EXPECT_EQ(value, byte == 1);
    } else {
      EXPECT_THROW(reader.get(value), InputError) << byte;
    }
  }
}

}  // namespace
}  // namespace gigabake
