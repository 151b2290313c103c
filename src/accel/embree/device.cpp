#include "accel/embree/device.h"

#include <utility>

#include "relume/error.h"

namespace relume::embree {

Device::Device() : device_(rtcNewDevice(nullptr)) {
  if (!device_) throw Error("Embree could not start on this processor; it needs at least SSE2");
  const auto keep_error = [](void* context, RTCError code, const char* text) {
    auto& device = *static_cast<Device*>(context);
    device.error_ = code;
    device.error_text_ = text ? text : "unknown error";
  };
  rtcSetDeviceErrorFunction(device_, keep_error, this);
  const auto count_bytes = [](void* bytes, ssize_t change, bool) {
    *static_cast<std::atomic<int64_t>*>(bytes) += change;
    return true;
  };
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
}

Device::~Device() { rtcReleaseDevice(device_); }

void Device::check(RTCError ignored) {
  const RTCError error = std::exchange(error_, RTC_ERROR_NONE);
  if (error == RTC_ERROR_NONE || error == ignored) return;
  throw Error("the acceleration structure could not be built: Embree reports '" + error_text_ +
              "'; try a smaller scene, or free some memory");
}

std::string Device::version() const {
  const auto part = [&](RTCDeviceProperty name) { return std::to_string(rtcGetDeviceProperty(device_, name)); };
  return part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
         part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
}

}  // namespace relume::embree
