#include "experiments/setup/apply_settings.h"

#include <string>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

TEST(ApplySettings, ChangesTheNamedOnes) {
  RenderSettings settings;
  apply_settings("cache:psf,max-bounces:3", "here", settings);
  EXPECT_EQ(settings.cache, CacheChoice::psf);
  EXPECT_EQ(settings.path.max_bounces, 3);
  apply_settings("", "here", settings);
  EXPECT_EQ(settings.path.max_bounces, 3);
}

TEST(ApplySettings, NamesThePlaceOfErrors) {
  RenderSettings settings;
  try {
    apply_settings("cache:psg", "here", settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("here"), 0u) << error.what();
  }
}

}  // namespace
}  // namespace relume
