#include "worker/pipeline/materials.h"

#include <gtest/gtest.h>
#include <limits>

namespace gigabake {
namespace {

Material textured(AlphaMode mode, float factor_alpha = 1, float cutoff = 0.5f) {
  Material m;
  m.base_color = {1, 0.5f, 0, factor_alpha};
  m.texture.image = 3;
  m.alpha_mode = mode;
  m.alpha_cutoff = cutoff;
  return m;
}

TEST(ShadedMaterial, KeepsFactorsAsLinear16Bit) {
  const auto m = shaded_material(textured(AlphaMode::blend, 0.25f));
  EXPECT_EQ(m.view.base_rgba[0], 65535);
  EXPECT_EQ(m.view.base_rgba[1], 32768);
  EXPECT_EQ(m.view.base_rgba[2], 0);
  EXPECT_EQ(m.view.base_rgba[3], 16384);
}

TEST(ShadedMaterial, TakesFactorsThatAreNoNumbersAsZeroAndClampsOthers) {
  Material material;
  material.base_color = {std::numeric_limits<float>::quiet_NaN(), -3, 7, std::numeric_limits<float>::infinity()};
  const auto m = shaded_material(material);
  EXPECT_EQ(m.view.base_rgba[0], 0);
  EXPECT_EQ(m.view.base_rgba[1], 0);
  EXPECT_EQ(m.view.base_rgba[2], 65535);
  EXPECT_EQ(m.view.base_rgba[3], 0);
}

TEST(ShadedMaterial, IgnoresTheImagesAlphaWhenOpaque) {
  const auto m = shaded_material(textured(AlphaMode::opaque));
  EXPECT_EQ(m.image, 3);
  EXPECT_EQ(m.filter_key, TextureFilterKey{});
  EXPECT_EQ(m.view.alpha_mode, AlphaMode::opaque);
}

TEST(ShadedMaterial, KeepsTheImagesAlphaWhenBlended) {
  EXPECT_EQ(shaded_material(textured(AlphaMode::blend)).filter_key.alpha, kernels::TextureAlpha::blend);
}

TEST(ShadedMaterial, TurnsTheCutoffIntoTheMinTexelThatPasses) {
  const auto cutoff_of = [](float cutoff, float factor) {
    const auto m = shaded_material(textured(AlphaMode::mask, factor, cutoff));
    EXPECT_EQ(m.filter_key.alpha, kernels::TextureAlpha::mask);
    return int(m.filter_key.mask_cutoff);
  };
  EXPECT_EQ(cutoff_of(0.5f, 1), 128);
  EXPECT_EQ(cutoff_of(0.2f, 1), 51);  // 0.2f is a little above 51/255
  EXPECT_EQ(cutoff_of(0.4f, 0.8f), 128);
  EXPECT_EQ(cutoff_of(1, 1), 255);
  EXPECT_EQ(cutoff_of(0.5f, 0.5f), 255);
  EXPECT_EQ(cutoff_of(1e-6f, 1), 1);
}

TEST(ShadedMaterial, IsOpaqueWhereEverythingPassesTheCutoff) {
  const auto m = shaded_material(textured(AlphaMode::mask, 1, 0));
  EXPECT_EQ(m.view.alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(m.filter_key, TextureFilterKey{});
}

TEST(ShadedMaterial, IsAbsentWhereNothingPassesTheCutoff) {
  for (const auto& material : {textured(AlphaMode::mask, 0.3f, 0.5f), textured(AlphaMode::mask, 1, 1.5f),
                               textured(AlphaMode::mask, 0, 0.5f)}) {
    const auto m = shaded_material(material);
    EXPECT_EQ(m.image, -1);
    EXPECT_LT(m.view.base_rgba[3], m.view.cutoff);
  }
}

TEST(ShadedMaterial, CarriesWrapAndFilterOver) {
  Material material = textured(AlphaMode::opaque);
  material.texture.wrap_s = Wrap::clamp_to_edge;
  material.texture.wrap_t = Wrap::mirrored_repeat;
  material.texture.nearest = true;
  const auto m = shaded_material(material);
  EXPECT_EQ(m.view.wrap_s, Wrap::clamp_to_edge);
  EXPECT_EQ(m.view.wrap_t, Wrap::mirrored_repeat);
  EXPECT_TRUE(m.view.nearest);
}

}  // namespace
}  // namespace gigabake
