// Compares frames of the host with those of the emulated device.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "determinism/moving_frames.h"
#include "device/emulated_device.h"
#include "device/kernels.h"
#include "support/technique_checks.h"
#include "support/watch_accesses.h"

namespace relume::support {

/// Small images of a technique in the forms of a device.
inline RenderSettings device_settings(const DeterminismCheck& technique, const ImageSize& size = {}) {
  RenderSettings s = moving_settings(technique, size);
  s.accel = AccelChoice::bvh;
  s.scalar_kernels = true;
  return s;
}

/// A session on the host and one on the emulated device, of one scene.
class HostAndDevice {
 public:
  explicit HostAndDevice(const Scene& scene, const std::vector<const ptx::Module*>& code = {&ptx::all_kernels},
                         const ImageSize& size = {})
      : size_(size),
        host_(scene, first_settings()),
        on_device_(make_session(scene, first_settings(), std::make_unique<testing::EmulatedDevice>(walls_, code))) {
    watch_accesses(on_device_, walls_);
  }
  ~HostAndDevice() {
    for (const std::string& violation : walls_.violations()) ADD_FAILURE() << violation;
  }
  HostAndDevice(const HostAndDevice&) = delete;
  HostAndDevice& operator=(const HostAndDevice&) = delete;

  Session& host() { return host_; }
  Session& on_device() { return on_device_; }

  /// Whether all frames of a technique have the same bits. `frame_s`, `count`: as for moving_frames().
  bool agrees(const DeterminismCheck& technique, float frame_s = 0, int count = kMovingFrames) {
    const RenderSettings settings = device_settings(technique, size_);
    return moving_frames(host_, settings, frame_s, count) == moving_frames(on_device_, settings, frame_s, count);
  }

 private:
  RenderSettings first_settings() const { return device_settings(technique_checks().determinism.front(), size_); }

  ImageSize size_;
  testing::WalledMemory walls_;
  Session host_;
  Session on_device_;
};

}  // namespace relume::support
