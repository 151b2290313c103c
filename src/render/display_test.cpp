#include "render/display.h"

#include <gtest/gtest.h>

#include <vector>

#include "framebuffer/auto_exposure.h"
#include "render/settings.h"

namespace relume {
namespace {

TEST(Display, ResolvesAutomaticSettings) {
  const std::vector<Rgb> image(100, Rgb(0.72f));
  OutputSettings settings;
  EXPECT_EQ(display_for(settings, image, true), (Display{auto_exposure(image), ToneMap::neutral}));
  EXPECT_EQ(display_for(settings, image, false), (Display{auto_exposure(image), ToneMap::agx}));
  EXPECT_EQ(fixed_display(settings), (Display{0, ToneMap::agx}));
  settings.exposure = 1.5f;
  settings.tone_map = static_cast<ToneMapChoice>(ToneMap::aces);
  EXPECT_EQ(display_for(settings, image, true), (Display{1.5f, ToneMap::aces}));
  EXPECT_EQ(fixed_display(settings), (Display{1.5f, ToneMap::aces}));
}

TEST(Display, ExposureAdaptsEquallyAtAnyFrameRate) {
  const float half_second = adapted_exposure(0, 4, 0.5f);
  EXPECT_NEAR(half_second, 3.0f, 1e-5f);
  float slow = 0;
  for (int i = 0; i < 12; ++i) slow = adapted_exposure(slow, 4, 0.5f / 12);
  EXPECT_NEAR(slow, half_second, 1e-4f);
  EXPECT_EQ(adapted_exposure(2, 2, 0.04f), 2.0f);
}

}  // namespace
}  // namespace relume
