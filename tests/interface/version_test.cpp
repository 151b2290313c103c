#include "relume/version.h"

#include <gtest/gtest.h>

#include <string>

namespace relume {
namespace {

TEST(Version, HeadersAndLibraryAgree) {
  EXPECT_EQ(version(), std::to_string(RELUME_VERSION_MAJOR) + "." + std::to_string(RELUME_VERSION_MINOR) + "." +
                           std::to_string(RELUME_VERSION_PATCH));
}

}  // namespace
}  // namespace relume
