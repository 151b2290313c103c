#include "viewer/render/session_slot.h"

#include <algorithm>

#include "core/clock.h"
#include "viewer/render/inspect.h"

namespace relume::viewer {
namespace {

/// Sets a value until the end of the scope.
class ScopedValue {
 public:
  ScopedValue(std::atomic<double>& target, double value) : target_(target), before_(target.exchange(value)) {}
  ~ScopedValue() { target_ = before_; }
  ScopedValue(const ScopedValue&) = delete;
  ScopedValue& operator=(const ScopedValue&) = delete;

 private:
  std::atomic<double>& target_;
  double before_;
};

std::optional<double> start_of(double since_s, double idle) {
  return since_s == idle ? std::nullopt : std::optional(since_s);
}

}  // namespace

std::optional<double> SessionSlot::compiling_since_s() const { return start_of(compiling_since_s_, kIdle); }
std::optional<double> SessionSlot::updating_since_s() const { return start_of(updating_since_s_, kIdle); }

void SessionSlot::compile(const RenderRequest& request, const RenderSettings& settings) {
  const ScopedValue compiling(compiling_since_s_, now_s());
  // Keeps the old session until the new one is complete, in case the scene cannot be compiled.
  Scene scene = request.scene->scene;
  // Compilation needs the edited environment, because it lights a scene that has no light.
  const Edit<std::shared_ptr<const Environment>>& environment = request.edits.environment;
  if (environment.version > 0) scene.environment = *environment.value;
  const std::string& variant = request.settings[0].scene.variant;
  choose_variant(scene, variant);
  Session fresh(std::move(scene), settings, request.edits.movable);
  environment_ = environment.version;
  session_ = std::move(fresh);
  scene_ = request.scene;
  movable_ = request.edits.movable;
  variant_ = variant;
  applied_ = 0;
}

void SessionSlot::apply_motion(const SceneEdits& edits) {
  if (edits.time_s.version > applied_) session_->set_time(edits.time_s.value);
  if (edits.camera.version > applied_) session_->set_camera(edits.camera.value);
}

void SessionSlot::apply_changes(const SceneEdits& edits) {
  const auto newer = [&](const auto& edit) { return edit.version > applied_; };
  if (newer(edits.environment) && edits.environment.version > environment_)
    session_->set_environment(*edits.environment.value);
  for (const auto& [node, edit] : edits.nodes) {
    if (newer(edit)) session_->set_transform(node, edit.value);
  }
  for (const auto& [light, edit] : edits.lights) {
    if (newer(edit)) session_->set_light(light, edit.value);
  }
  for (const auto& [material, edit] : edits.materials) {
    if (newer(edit)) session_->set_material(material, edit.value);
  }
  applied_ = std::max(applied_, edits.version);
}

void SessionSlot::update(const RenderRequest& request, int side, const FrameScale& scale) {
  RenderSettings settings = request.settings[static_cast<size_t>(side)].render;
  settings.width = scale.size.x;
  settings.height = scale.size.y;
  settings.switches_upscaling = scale.switches_upscaling;
  if (scale.switches_upscaling) settings.upscaling.factor = scale.upscale;
  settings.auxiliary = needs_auxiliary(settings, request.buffer);
  // Time is applied by set_time(), so that an animation does not count as a changed setting.
  if (request.edits.time_s.version > 0) settings.time_s = request.edits.time_s.value;
  const bool compiled = session_ && scene_ == request.scene && movable_ == request.edits.movable &&
                        variant_ == request.settings[0].scene.variant;
  if (compiled) apply_motion(request.edits);
  const ScopedValue updating(updating_since_s_, now_s());
  if (compiled) apply_changes(request.edits);
  if (!compiled || !session_->set_settings(settings)) {
    compile(request, settings);
    apply_motion(request.edits);
    apply_changes(request.edits);
  }
  if (session_->frames_since_change() == 0) session_->begin_image();
}

PickResult pick(const Session& session, const Vec2& point) {
  const CompiledScene& scene = compiled_scene(session);
  const SceneView& view = scene.view();
  CameraView camera = view.camera;
  camera.lens_radius = 0;
  const Ray ray = generate(camera, point * camera.resolution, Vec2(0));
  const Hit hit = intersect_from_camera(view.accel, ray, 0);
  PickResult result;
  if (!hit.valid()) return result;
  result.hit = true;
  result.node = scene.node_of(hit.instance);
  result.position = ray.origin + ray.direction * hit.t;
  return result;
}

}  // namespace relume::viewer
