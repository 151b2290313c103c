// Tests that sessions run on the devices that replace the host.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "determinism/same_bits.h"
#include "device/emulated_device.h"
#include "device/kernels.h"
#include "render/session.h"
#include "support/measure.h"
#include "testing/walled_memory.h"

namespace relume::support {
namespace {

class ReplacedHost : public ::testing::Test {
 protected:
  void SetUp() override {
    replace_host([this] {
      auto device = std::make_unique<testing::EmulatedDevice>(
          walls_, std::vector<const ptx::Module*>{&ptx::all_kernels}, ++devices_);
      last_ = device.get();
      return device;
    });
  }
  void TearDown() override { replace_host({}); }

  testing::WalledMemory walls_;
  uint32_t devices_ = 0;
  testing::EmulatedDevice* last_ = nullptr;
};

TEST_F(ReplacedHost, RunsEachSessionOnADevice) {
  RenderSettings settings = small_settings(24, 16);
  Session first(build("cornell"), settings);
  Session second(build("cornell"), settings);
  EXPECT_EQ(devices_, 2u);
  const size_t built = last_->launches();
  for (Session* session : {&first, &second}) session->render_frame();
  EXPECT_GT(last_->launches(), built);
  EXPECT_EQ(bits_of(first), bits_of(second)) << "the order of blocks and threads changes the image";
  replace_host({});
  settings.accel = AccelChoice::bvh;
  Session on_host(build("cornell"), settings);
  on_host.render_frame();
  EXPECT_EQ(devices_, 2u);
  EXPECT_EQ(bits_of(first), bits_of(on_host));
}

}  // namespace
}  // namespace relume::support
