// Internal access to a session for the library, its program and its tests.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "frame/device.h"
#include "frame/pass.h"
#include "framebuffer/buffer_table.h"
#include "relume/session.h"
#include "render/render_settings.h"
#include "scene/compiled_scene.h"

namespace relume {

const RenderSettings& render_settings(const Session& session);
const CompiledScene& compiled_scene(const Session& session);
/// The samples in a session's image.
struct RenderedSamples {
  uint32_t first = 0;  ///< SampleSettings::first
  uint32_t count = 0;  ///< per pixel, since the last change
  uint32_t correlated_frames = 1;
  bool adapt = false;  ///< samples_adapt()
};
RenderedSamples rendered_samples(const Session& session);
/// Per-pixel buffers of the session.
const BufferTable& buffer_table(const Session& session);
/// Declarations of the passes that fill them.
std::vector<PassDeclaration> pass_declarations(const Session& session);
/// A session whose kernels access `memory`, which must outlive it. Throws as the constructor of Session.
Session make_session(Scene scene, const Settings& settings, Memory& memory);
/// A session whose kernels run on `device`. Throws as the constructor of Session, and Error if the settings do not
/// choose relume's BVH.
Session make_session(Scene scene, const Settings& settings, std::unique_ptr<Device> device);
/// Copies the session's image for a window (Device::copy_image()). Returns nullptr if it is in host memory, or if the
/// device cannot copy it. Throws as Device::copy_image().
std::shared_ptr<DeviceImage> copy_device_image(Session& session);
/// auto_exposure() of that image. The device copies only the pixels that it reads to the host.
float meter_device_image(Session& session);
/// Whether the session's device has failed in a way that it does not survive (Device::finish()).
bool device_is_lost(const Session& session);
/// Sessions constructed from now on whose setting `device` chooses the processor run their kernels on the devices that
/// `open` returns, or on the processor where it returns nullptr, as if the setting had chosen these. Tests use it to
/// run all sessions on an emulated device. Empty: their kernels run on the processor. Call it while no thread
/// constructs a session.
void replace_host(std::function<std::unique_ptr<Device>()> open);
/// Whether replace_host() has been given devices.
bool is_host_replaced();
/// Calls `hook` before each tile of a launch (Backend::on_tile()).
void on_tile(Session& session, std::function<void()> hook);
/// Calls `hook` at each step of a launch (Backend::on_launch()).
void on_launch(Session& session, std::function<void(const LaunchEvent&)> hook);

}  // namespace relume
