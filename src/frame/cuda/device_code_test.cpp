#include "frame/cuda/device_code.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace relume {
namespace {

#ifdef RELUME_PTX_FILE

TEST(DeviceCode, IsThatOfTheBuild) {
  std::ifstream file(RELUME_PTX_FILE, std::ios::binary);
  const std::string built(std::istreambuf_iterator<char>(file), {});
  EXPECT_GT(built.size(), 1000u);
  EXPECT_TRUE(device_code() == built);
}

TEST(DeviceCode, TakesLittleOfTheLibrary) {
  EXPECT_GT(device_code_bytes(), 0u);
  EXPECT_LT(device_code_bytes(), size_t{3} << 19);  // of 12 MB
}

#else

TEST(DeviceCode, IsEmptyWithoutACompiler) {
  EXPECT_EQ(device_code(), "");
  EXPECT_EQ(device_code_bytes(), 0u);
}

#endif

}  // namespace
}  // namespace relume
