#include "relume/session.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "frame/cuda/device_choice.h"
#include "relume/error.h"
#include "render/aov.h"
#include "render/session.h"
#include "render/session_access.h"
#include "render/session_state.h"
#include "render/settings.h"
#include "techniques/temporal/accumulate/accumulate_pass.h"

namespace relume {
namespace {

/// Whether two plans have equal passes and buffers.
bool same_plan(const std::vector<PassDeclaration>& a, const std::vector<PassDeclaration>& b) {
  const auto same_buffers = [](const BufferDescription& x, const BufferDescription& y) {
    return x.id == y.id && x.reset == y.reset;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const PassDeclaration& x, const PassDeclaration& y) {
    return x.name == y.name && x.reads == y.reads && x.writes == y.writes && x.reads_if_any == y.reads_if_any &&
           x.writes_if_any == y.writes_if_any &&
           std::equal(x.owns.begin(), x.owns.end(), y.owns.begin(), y.owns.end(), same_buffers);
  });
}

void check_size(const RenderSettings& settings) {
  if (settings.width < 1 || settings.height < 1)
    throw Error(fmt::format("an image of {}x{} pixels cannot be rendered; --width and --height must be at least 1",
                            settings.width, settings.height));
  const PixelWindow& crop = settings.crop;
  const bool fits = crop.x >= 0 && crop.y >= 0 && crop.width >= 1 && crop.height >= 1 &&
                    crop.width <= settings.width - crop.x && crop.height <= settings.height - crop.y;
  if (!crop.empty() && !fits)
    throw Error(fmt::format("--crop {},{},{},{} is not within the image of {}x{} pixels; give X,Y,W,H within it",
                            crop.x, crop.y, crop.width, crop.height, settings.width, settings.height));
}

/// Opens the devices that replace the host; empty: none.
std::function<std::unique_ptr<Device>()>& host_replacement() {
  static std::function<std::unique_ptr<Device>()> open;
  return open;
}

/// The device of a session; nullptr: the host executes its kernels.
std::unique_ptr<Device> open_device_of(const RenderSettings& settings) {
  std::unique_ptr<Device> device = cuda::open_chosen_device(settings.device);
  if (!device && is_host_replaced()) device = host_replacement()();
  return device;
}

/// Sets a flag during its lifetime.
class FrameMark {
 public:
  explicit FrameMark(bool& flag) : flag_(flag) { flag_ = true; }
  ~FrameMark() { flag_ = false; }
  FrameMark(const FrameMark&) = delete;
  FrameMark& operator=(const FrameMark&) = delete;

 private:
  bool& flag_;
};

}  // namespace

std::vector<PassTime> pass_times_since(std::vector<PassTime> now, const std::vector<PassTime>& before) {
  for (PassTime& pass : now) {
    const auto old = std::find_if(before.begin(), before.end(), [&](const PassTime& b) { return b.name == pass.name; });
    if (old == before.end()) continue;
    pass.seconds -= old->seconds;
    pass.idle_s -= old->idle_s;
  }
  return now;
}

Session::Session(Scene scene, const Settings& settings, std::vector<Index> movable) {
  RenderSettings render = all_settings(settings).render;
  check_size(render);
  std::unique_ptr<Device> device = open_device_of(render);
  if (!device) {
    state_ = std::make_unique<State>(std::move(scene), render, std::move(movable), host_memory());
    return;
  }
  render.accel = AccelChoice::bvh;
  state_ = std::make_unique<State>(std::move(scene), render, std::move(movable), std::move(device));
}
Session::Session(std::unique_ptr<State> state) : state_(std::move(state)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

bool Session::render_frame(std::stop_token stop) {
  State& s = *state_;
  s.check_between_frames();
  const FrameMark mark(s.in_frame);
  const double start_s = now_s();
  s.next_replacement.clear();
  s.backend->run(kSessionWork, [&] { s.commit_edits(); });
  s.rebuild_stale_scene();
  const bool may_lose_image = stop.stop_possible() && s.changes != Change::none;
  if (may_lose_image) s.backend->run(kSessionWork, [&] { s.keep_image(); });
  const bool restores = stop.stop_possible() && s.passes.pipeline.stops_late();
  bool complete = false;
  bool kept = false;
  FirstError errors;
  s.buffers->swap();
  try {
    s.backend->run(kSessionWork, [&] {
      s.apply_changes();
      complete = s.buffers->clear_new(stop);
      if (complete && restores) s.buffers->keep();
    });
    kept = complete && restores;
    const auto hook = s.pass_hook;  // a hook may replace itself
    complete = complete && s.passes.pipeline.run(s.frame(stop), hook);
    if (complete) s.end_frame();
  } catch (...) {
    errors.add_current();
    complete = false;
  }
  if (!complete) s.undo_frame(kept, may_lose_image, errors);
  errors.rethrow();
  s.statistics.render_s += now_s() - start_s;
  return complete;
}

void Session::shorten_preparation_on(std::stop_token token) { state_->hurry = std::move(token); }
bool Session::prepared() const { return state_->passes.pipeline.prepared(); }

uint32_t Session::frames_since_change() const { return state_->changes == Change::none ? state_->own_frames() : 0; }

double Session::kept_samples() const {
  const uint64_t samples = state_->sum(kBetweenFrames, state_->buffers->view(kSamples));
  return static_cast<double>(samples) / static_cast<double>(state_->rendered_pixels());
}

void Session::begin_image() {
  state_->check_between_frames();
  Counters& c = state_->counters;
  c.image_frames = c.frames;
  c.image_paths = c.paths;
  state_->image_begun_s = state_->statistics.render_s;
}

uint32_t Session::image_frames() const { return state_->counters.frames - state_->counters.image_frames; }

double Session::image_samples() const {
  const Counters& c = state_->counters;
  return static_cast<double>(c.paths - c.image_paths) / static_cast<double>(state_->rendered_pixels());
}

double Session::image_render_s() const { return state_->statistics.render_s - state_->image_begun_s; }

double Session::estimated_error() const {
  const uint32_t pilot = pilot_samples(state_->settings);
  if (pilot > 0 && state_->counters.since_change <= pilot)
    return std::numeric_limits<double>::infinity();  // the samples so far will be dropped
  const BufferTable& buffers = *state_->buffers;
  const Tile all{0, 0, buffers.width(), buffers.height()};
  const ImageErrors image{{buffers.view(kMean), buffers.view(kMoments.m2), {}, buffers.view(kSamples)},
                          {buffers.view(kLightM2), buffers.view(kLightPaths), buffers.view(kLightFrames)},
                          state_->settings.crop.empty() ? all : state_->window(),
                          buffers.width(),
                          state_->passes.pipeline.correlated_frames()};
  return relative_error({*state_->backend, kBetweenFrames, state_->scratch}, image);
}

const Statistics& Session::statistics() const {
  State& s = *state_;
  s.statistics.frames = s.counters.frames - s.first_frame();
  s.statistics.samples = s.statistics.paths = s.counters.paths;
  s.statistics.rays = s.counters.rays;
  s.statistics.nonfinite_samples = s.sum(kBetweenFrames, s.buffers->view(kNonfinite));
  s.statistics.scene_bytes = s.scene->memory_bytes();
  s.statistics.buffer_bytes = s.buffers->memory_bytes() + s.pool->spare_bytes();
  s.statistics.technique_bytes = s.passes.pipeline.memory_bytes() + s.blue_noise.memory_bytes();
  s.statistics.threads = s.backend->threads();
  s.statistics.passes.clear();
  for (const LaunchTime& t : s.backend->times()) {
    if (t.name != kBetweenFrames) s.statistics.passes.push_back({t.name, t.seconds, t.idle_s});
  }
  s.statistics.pass_statistics = s.passes.pipeline.statistics();
  s.statistics.device = s.device ? s.device->statistics() : std::nullopt;
  return s.statistics;
}

bool Session::in_studio() const { return state_->scene->in_studio(); }

const std::vector<std::string>& Session::notes() const { return state_->scene->notes(); }
std::vector<std::string> Session::warnings() const { return state_->passes.pipeline.warnings(); }
uint64_t Session::scene_hash() const { return state_->hash; }
CameraPose Session::camera() const { return state_->scene->camera(); }

std::vector<std::string> Session::aov_names(const Settings& settings) {
  return names_of(aov_layers(plan(all_settings(settings).render)));
}

std::vector<ExrChannel> Session::aov(const std::string& name) const {
  return aov_planes(*state_->buffers, name, state_->own_frames(), state_->passes.pipeline.correlated_frames());
}

bool Session::set_settings(const Settings& wanted) {
  state_->check_between_frames();
  State& s = *state_;
  RenderSettings settings = all_settings(wanted).render;
  RenderSettings& current = s.settings;
  if (s.device) settings.accel = AccelChoice::bvh;
  if (settings.texture_filter != current.texture_filter || settings.accel != current.accel ||
      settings.device != current.device || settings.camera != current.camera ||
      settings.animation != current.animation || settings.samples != current.samples)
    return false;
  check_size(settings);
  // Throws for incompatible settings before anything changes.
  const bool same_passes = same_plan(plan(settings), s.passes.pipeline.declarations());
  SettingList slots = describe_slots(settings);
  const bool same_slots = differing_settings(describe_slots(current), slots).empty();
  const bool resized =
      settings.width != current.width || settings.height != current.height || settings.crop != current.crop;
  Change change = Change::none;
  const SettingList before = describe(current);  // the result contains pointers into it
  const bool switches_upscaling = settings.switches_upscaling && current.switches_upscaling;
  for (const Setting* setting : differing_settings(before, describe(settings))) {
    const bool keeps_histories = setting->name == "upscale" && switches_upscaling;
    if (setting->traits.resets_history && !keeps_histories) change = Change::settings;
  }
  // Steps that may throw come first. If one does, the session keeps its settings, except perhaps the time, the shutter,
  // and the threads and the form of its kernels, which change no bits.
  std::optional<State::Fresh> fresh;
  if (resized || !same_slots || !same_passes) fresh = s.empty_pipeline(settings);
  if (fresh && !resized) s.keep_image();
  if (settings.time_s != current.time_s) set_time(settings.time_s);
  if (settings.shutter() != s.scene->shutter())
    s.edit([&](CompiledScene& scene) { return scene.set_shutter(settings.shutter()); });
  if (settings.threads != current.threads || settings.scalar_kernels != current.scalar_kernels)
    s.backend->configure(settings.threads, kernel_form(settings));
  if (resized) s.edit([&](CompiledScene& scene) { return scene.set_resolution(settings.width, settings.height); });
  s.edit(change);
  current = std::move(settings);
  if (!fresh) {
    configure(s.passes, current);
    return true;
  }
  if (resized) {
    s.replacement.clear();
    s.drop_kept_image();
  } else {
    s.show_kept_image();
  }
  s.take(std::move(*fresh));
  s.edit(Change::settings);  // the new buffers are empty, even if only `auxiliary` changed
  return true;
}

void Session::restart(int seed) {
  state_->check_between_frames();
  State& s = *state_;
  s.rebuild_stale_scene();
  s.settings.seed = seed;
  s.replacement.clear();
  s.drop_kept_image();
  s.rebuild_pipeline();
  s.scene->end_frame();
  s.counters = s.first_counters();
  s.image_begun_s = s.statistics.render_s;
  s.changes = Change::none;
  s.edited = false;
}

void Session::save_checkpoint(const std::filesystem::path& file) const {
  state_->check_between_frames();
  state_->check_unedited(file);
  write_checkpoint(file, {state_->hash, checkpoint_key(state_->settings), state_->counters}, *state_->buffers,
                   state_->passes.pipeline);
}

void Session::load_checkpoint(const std::filesystem::path& file) {
  state_->check_between_frames();
  State& s = *state_;
  s.check_unedited(file);
  // Loads into passes that have not run: others keep state of the scene at their time.
  State::Fresh fresh = s.empty_pipeline(s.settings);
  const Counters counters =
      read_checkpoint(file, {s.hash, checkpoint_key(s.settings), {}}, *fresh.buffers, fresh.passes.pipeline);
  // First, because it may throw.
  s.change_scene([&](CompiledScene& scene) { return scene.set_time(counters.previous_time_s); });
  s.counters = counters;
  s.replacement.clear();
  s.drop_kept_image();
  s.take(std::move(fresh));
  s.image_begun_s = s.statistics.render_s;
  s.scene->end_frame();
  set_time(s.counters.time_s);
  if (s.counters.time_s == s.counters.previous_time_s) s.changes = Change::none;
  s.edited = false;
}

Session make_session(Scene scene, const Settings& settings, Memory& memory) {
  const RenderSettings render = all_settings(settings).render;
  check_size(render);
  return SessionAccess::make(std::move(scene), render, memory);
}
Session make_session(Scene scene, const Settings& settings, std::unique_ptr<Device> device) {
  const RenderSettings& render = all_settings(settings).render;
  if (render.accel != AccelChoice::bvh)
    throw Error("a device cannot use Embree's acceleration structure; set --accel bvh");
  check_size(render);
  return SessionAccess::make(std::move(scene), render, std::move(device));
}

bool device_is_lost(const Session& session) {
  Device* const device = SessionAccess::state(session).device.get();
  if (!device) return false;
  try {
    device->finish();
    return false;
  } catch (const Error&) {
    return true;
  }
}

void replace_host(std::function<std::unique_ptr<Device>()> open) { host_replacement() = std::move(open); }
bool is_host_replaced() { return host_replacement() != nullptr; }

void on_tile(Session& session, std::function<void()> hook) {
  SessionAccess::state(session).backend->on_tile(std::move(hook));
}
void on_launch(Session& session, std::function<void(const LaunchEvent&)> hook) {
  SessionAccess::state(session).backend->on_launch(std::move(hook));
}
const RenderSettings& render_settings(const Session& session) { return SessionAccess::state(session).settings; }
const CompiledScene& compiled_scene(const Session& session) { return *SessionAccess::state(session).scene; }
RenderedSamples rendered_samples(const Session& session) {
  const auto& s = SessionAccess::state(session);
  return {.first = s.settings.samples.first,
          .count = s.own_frames(),
          .correlated_frames = s.passes.pipeline.correlated_frames(),
          .adapt = samples_adapt(s.settings)};
}
const BufferTable& buffer_table(const Session& session) { return *SessionAccess::state(session).buffers; }
std::vector<PassDeclaration> pass_declarations(const Session& session) {
  return SessionAccess::state(session).passes.pipeline.declarations();
}

}  // namespace relume
