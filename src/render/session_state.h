// State of a session.
#pragma once

#include <atomic>
#include <concepts>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/accel_choice.h"
#include "core/clock.h"
#include "core/first_error.h"
#include "core/hash.h"
#include "frame/device.h"
#include "frame/launch.h"
#include "frame/primitives/reduce.h"
#include "framebuffer/block_pool.h"
#include "relume/error.h"
#include "relume/session.h"
#include "render/backend_scene_launcher.h"
#include "render/build_pipeline.h"
#include "render/checkpoint.h"
#include "render/sample_parts.h"
#include "render/summed_layers.h"
#include "sampling/blue_noise.h"
#include "sampling/sample_schedule.h"
#include "scene/compiled_scene.h"
#include "scene/scene_hash.h"

namespace relume {

/// Removed parts of the scene, by index.
struct RemovedParts {
  RemovedParts() = default;
  explicit RemovedParts(const Scene& scene)
      : nodes(scene.nodes.size()),
        meshes(scene.meshes.size()),
        materials(scene.materials.size()),
        lights(scene.lights.size()) {}

  std::vector<bool> nodes;
  std::vector<bool> meshes;
  std::vector<bool> materials;
  std::vector<bool> lights;
};

/// Unique number of a session within the process; from 1.
inline uint64_t next_session_number() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

inline KernelForm kernel_form(const RenderSettings& settings) {
  return settings.scalar_kernels ? KernelForm::device : KernelForm::host;
}

/// `device`: executes the kernels; nullptr: the host does, on `memory`.
inline std::unique_ptr<Backend> make_backend(const RenderSettings& settings, Memory& memory, Device* device) {
  if (device) return std::make_unique<Backend>(*device, settings.threads);
  return std::make_unique<Backend>(settings.threads, kernel_form(settings), memory, denormals_with(settings.accel));
}

/// Name of a session's own work in timings: in a frame, it clears, copies and restores buffers, rebuilds edited parts
/// of the scene, and advances the scene.
inline constexpr std::string_view kSessionWork = "session";

/// Name of changes of the scene between frames in timings.
inline constexpr std::string_view kSceneChanges = "scene";

struct Session::State {
  /// The host executes the kernels. `memory`: for all data that kernels access; it must outlive the state.
  State(Scene source, const RenderSettings& s, std::vector<Index> movable, Memory& memory)
      : State(std::move(source), s, std::move(movable), memory, nullptr) {}
  /// Kernels run on `kernel_device`, whose memory all kernel data use.
  State(Scene source, const RenderSettings& s, std::vector<Index> movable, std::unique_ptr<Device> kernel_device)
      : State(std::move(source), s, std::move(movable), kernel_device->memory(), std::move(kernel_device)) {}

  /// `kernel_device` nullptr: the host runs the kernels, on `memory`.
  State(Scene source, const RenderSettings& s, std::vector<Index> movable, Memory& memory,
        std::unique_ptr<Device>&& kernel_device)
      : settings(s),
        hash(relume::scene_hash(source)),
        device(std::move(kernel_device)),
        backend(make_backend(s, memory, device.get())),
        scene_launcher(*backend),
        blue_noise(memory),
        metered(memory),
        pool(BlockPool::create(memory)) {
    const double start_s = now_s();
    rebuild_pipeline();
    backend->run("build", [&] {
      scene = std::make_unique<CompiledScene>(
          std::move(source),
          CompileOptions{settings.camera, settings.animation, settings.time_s, settings.width, settings.height,
                         settings.texture_filter, std::move(movable), settings.accel, settings.shutter()},
          backend->memory(), scene_launcher);
    });
    counters = first_counters();
    statistics.build_s = now_s() - start_s;
    statistics.accel_s = scene->accel_build_s();
    removed = RemovedParts(scene->source());
  }

  /// Creates empty buffers and passes for the settings.
  void rebuild_pipeline() { take(empty_pipeline(settings)); }

  /// A pipeline and its buffers, without content.
  struct Fresh {
    std::unique_ptr<BufferTable> buffers;
    FramePasses passes;
  };
  Fresh empty_pipeline(const RenderSettings& s) const {
    Fresh fresh{std::make_unique<BufferTable>(static_cast<uint32_t>(s.width), static_cast<uint32_t>(s.height), pool),
                build_passes(s, backend->memory())};
    fresh.passes.pipeline.add_buffers(*fresh.buffers);
    return fresh;
  }
  /// Replaces the session's pipeline and buffers.
  void take(Fresh fresh) {
    const auto size = [](const BufferTable& table) { return std::pair(table.width(), table.height()); };
    const bool resized = buffers && size(*buffers) != size(*fresh.buffers);
    if (resized) pool->raise_limit(buffers->memory_bytes());
    buffers = std::move(fresh.buffers);
    summed.clear();
    passes = std::move(fresh.passes);
    if (resized) {
      pool->next_size();
    } else {
      pool->clear();
    }
  }

  /// Applies pending changes: clears the content that they invalidate, and starts new sample sequences if no history
  /// survives them.
  void apply_changes() {
    if (changes != Change::none) {
      buffers->reset(changes);
      counters.since_change = first_frame();
    }
    if (includes(changes, ends_sequences(settings))) {
      if (edited && counters.sequence_age > first_frame()) ++counters.epoch;
      counters.sequence_age = first_frame();
    }
    edited = false;
    if (counters.sequence_age == first_frame()) counters.stretch_time_s = counters.time_s;
  }

  /// Index of the first frame: that of the first sample, unless the session is a replica, which begins like any other.
  uint32_t first_frame() const { return samples_adapt(settings) ? 0 : settings.samples.first; }
  Counters first_counters() const {
    const uint32_t first = first_frame();
    return {.frames = first,
            .since_change = first,
            .time_s = settings.time_s,
            .previous_time_s = settings.time_s,
            .image_frames = first,
            .sequence_age = first};
  }
  /// Frames since the last change, without those of other parts.
  uint32_t own_frames() const { return counters.since_change - first_frame(); }

  /// Rendered pixels; empty: all pixels.
  Tile window() const {
    const auto at = [](int i) { return static_cast<uint32_t>(i); };
    const PixelWindow& c = settings.crop;
    return {at(c.x), at(c.y), at(c.x + c.width), at(c.y + c.height)};
  }
  uint64_t rendered_pixels() const {
    const PixelWindow& c = settings.crop;
    const int width = c.empty() ? settings.width : c.width;
    return static_cast<uint64_t>(width) * static_cast<uint64_t>(c.empty() ? settings.height : c.height);
  }

  /// The image of the last complete frame; empty before the first.
  View<const Rgb> shown() const {
    if (!replacement.empty()) return view_of(replacement);
    if (shows_kept_image) return view_of(kept_image);
    if (counters.frames == first_frame()) return {};
    if (has_sums(*buffers)) return mean_of_sums();
    return buffers->read(image_buffer());
  }
  /// The buffer of the image, if there are no sums.
  BufferKey<Rgb> image_buffer() const {
    for (const BufferKey<Rgb>& key : {kDenoised, kFilled}) {
      if (buffers->find(key.name)) return key;
    }
    return kMean;
  }
  /// The mean of the exact sums, computed once per frame.
  View<const Rgb> mean_of_sums() const {
    if (summed.empty() || in_frame) backend->execute([&] { summed = summed_image(*buffers, own_frames()); });
    return view_of(summed);
  }
  /// Copies the image. show_kept_image() displays the copy until the next complete frame.
  void keep_image() {
    if (shows_kept_image) return;
    const View<const Rgb> image = shown();
    kept_image.assign(image.begin(), image.end());
  }
  void show_kept_image() { shows_kept_image = shows_kept_image || !kept_image.empty(); }
  void drop_kept_image() {
    shows_kept_image = false;
    kept_image.clear();
  }

  /// Restores the state before a frame that was stopped or threw. `errors`: holds the frame's exception, if any; errors
  /// of the steps here are added. `kept`: whether BufferTable::keep() copied the buffers. `may_lose_image`: whether the
  /// frame may have cleared the displayed image, so that keep_image()'s copy replaces it.
  void undo_frame(bool kept, bool may_lose_image, FirstError& errors) {
    buffers->swap();
    if (kept) errors.attempt([&] { backend->run(kSessionWork, [&] { buffers->restore(); }); });
    // Without copies of the buffers, or after passes that cannot undo their changes, the image is no mean of samples.
    if (errors.any()) edit(Change::settings);
    if (may_lose_image) show_kept_image();
  }

  /// Adds changes that did not come from the animation.
  void edit(Change change) {
    changes |= change;
    edited = edited || change != Change::none;
  }
  /// Changes the scene on the session's threads. Returns the resulting differences. If a step of the change fails, the
  /// scene is empty until the next change or rebuild_stale_scene().
  template <typename F>
  Change change_scene(const F& change) {
    Change result = Change::none;
    try {
      backend->run(kSceneChanges, [&] {
        commit_edits();
        result = change(*scene);
      });
    } catch (...) {
      if (scene->is_stale()) edit(Change::any);
      throw;
    }
    return result;
  }
  /// Throws Error during a frame: hooks must not change what the frame reads.
  void check_between_frames() const {
    if (in_frame)
      throw Error("a hook changed the session during a frame; call this between frames, after render_frame()");
  }
  /// Throws Error if the scene no longer matches its hash, which a checkpoint would store.
  void check_unedited(const std::filesystem::path& file) const {
    if (!has_other_parts) return;
    throw Error(ErrorCode::not_supported, file.string() +
                                              ": parts were added to the scene or removed from it, which "
                                              "checkpoints do not store; start a session with the changed scene");
  }
  /// Rebuilds data affected by added or removed parts. Lights and instances are renumbered, so histories and caches are
  /// discarded.
  void commit_edits() {
    if (scene->commit_edits() != Change::none) has_other_parts = renumbered = true;
    if (!renumbered) return;
    keep_image();
    show_kept_image();
    rebuild_pipeline();
    edit(Change::any);
    renumbered = false;
  }
  template <typename F>
  requires std::invocable<F, CompiledScene&>
  void edit(const F& change) { edit(change_scene(change)); }
  /// Rebuilds the scene at the session's time if a change of it failed. Throws if this fails, too: a frame of the empty
  /// scene would be wrong.
  void rebuild_stale_scene() {
    if (scene->is_stale()) edit([&](CompiledScene& stale) { return stale.set_time(settings.time_s); });
  }

  /// Seed of the sample sequences. It depends on the animation time at which they start and on earlier edits, but not
  /// on the number of earlier frames.
  uint32_t scramble() const {
    auto seed = static_cast<uint32_t>(settings.seed);
    if (settings.samples.first > 0 && samples_adapt(settings)) seed = relume::hash(seed, settings.samples.first);
    if (counters.epoch == 0 && counters.stretch_time_s == 0.0f) return seed;
    return relume::hash(relume::hash(seed, counters.epoch), float_bits(counters.stretch_time_s));
  }

  SampleIndex sample_index(const SampleSchedule& schedule) {
    SampleIndex index{.seed = scramble(),
                      .sequence = counters.frames,
                      .frame = counters.frames,
                      .age = counters.sequence_age,
                      .width = buffers->width(),
                      .tile = settings.dither ? blue_noise_tile(blue_noise) : View<const uint16_t>{}};
    if (!settings.stratify) return index;  // one single-element sequence per frame
    index.sample = schedule.sample(counters.sequence_age, counters.since_change);
    index.sequence = schedule.sequence(counters.sequence_age, counters.since_change, counters.frames);
    if (index.sample == 0) uneven_samples = false;
    const bool even = settings.switches_upscaling && settings.upscaling.factor == 1 && !uneven_samples;
    if (!even) index.taken = buffers->view(kSequenceSamples);
    index.camera_runs = schedule.longest_epoch > 0;
    return index;
  }

  /// Blue noise that chooses the pixels with indirect light; empty if all have it.
  View<const uint16_t> blue_noise_of_frame() {
    return settings.path.indirect_rate < 1 ? blue_noise_tile(blue_noise) : View<const uint16_t>{};
  }

  FrameContext frame(const std::stop_token& stop) {
    const uint32_t pilot = pilot_samples(settings);
    const SampleSchedule schedule{passes.pipeline.longest_epoch(), pilot};
    const SampleIndex index = sample_index(schedule);
    const bool own_sequence = index.sample >= counters.since_change && index.taken.empty();
    // Merging joins paths of different pixels, which must show the scene at one time.
    const bool shares_time = settings.shutter().is_open() && settings.estimator == EstimatorChoice::vcm;
    scene->share_time(shares_time ? shared_shutter_time(index) : -1.0f);
    return FrameContext(scene->view(), *buffers, *backend,
                        {.index = index,
                         .number = counters.frames,
                         .since_change = counters.since_change,
                         .changes = changes,
                         .begins_image = counters.since_change == 0 || counters.image_frames == counters.frames,
                         .ends_pilot = pilot > 0 && counters.since_change == pilot,
                         .begins_epoch = schedule.begins_epoch(counters.since_change),
                         .turns = static_cast<uint32_t>(settings.upscaling.factor * settings.upscaling.factor),
                         .stratified = settings.stratify && own_sequence && passes.pipeline.keeps_to_pixels(),
                         .correlated_frames = passes.pipeline.correlated_frames(),
                         .stop = stop,
                         .window = window(),
                         .hurry = hurry,
                         .observed = pass_hook != nullptr,
                         .blue_noise = blue_noise_of_frame(),
                         .visible_sets = &scene->source().visible_sets});
  }

  /// Exact sum over the pixels, timed as `name`.
  uint64_t sum(std::string_view name, View<const uint32_t> values) {
    return relume::sum({*backend, name, scratch}, values);
  }

  /// Adds a completed frame to the counters. If it throws, the passes have undone the frame, and only the scene may
  /// have changed.
  void end_frame() {
    uint64_t paths = rendered_pixels();
    uint64_t rays = 0;
    try {
      const View<const uint32_t> allocation = buffers->view(kAllocation);
      if (!allocation.empty()) paths = sum("count", allocation);
      rays = sum("count", buffers->view(kRays));
      backend->run(kSessionWork, [&] { scene->end_frame(); });
    } catch (...) {
      FirstError errors;
      errors.add_current();
      errors.attempt([&] { passes.pipeline.abandon(); });
      errors.rethrow();
    }
    uneven_samples = uneven_samples || paths < rendered_pixels();
    counters.paths += paths;
    counters.rays += rays;
    ++counters.frames;
    ++counters.since_change;
    ++counters.sequence_age;
    drop_kept_image();
    summed.clear();
    replacement = std::move(next_replacement);
    changes = Change::none;
    counters.previous_time_s = counters.time_s;
  }

  const uint64_t number = next_session_number();
  RenderSettings settings;
  uint64_t hash;
  std::unique_ptr<Device> device;  ///< nullptr: the host executes the kernels
  std::unique_ptr<Backend> backend;
  BackendSceneLauncher scene_launcher;
  PrimitiveScratch scratch;
  Array<uint16_t> blue_noise;       ///< blue_noise_tile() for kernels; empty until used
  Array<Rgb> metered;               ///< pixels of the image that auto_exposure() reads; empty until used
  std::shared_ptr<BlockPool> pool;  ///< memory of `buffers`, across image sizes
  std::unique_ptr<BufferTable> buffers;
  FramePasses passes;
  std::unique_ptr<CompiledScene> scene;
  Change changes = Change::none;
  bool edited = false;          ///< whether `changes` include any from outside the animation
  bool uneven_samples = false;  ///< whether pixels have different sample counts since their sequences began
  Counters counters;
  std::stop_token hurry;  ///< see Session::shorten_preparation_on()
  RemovedParts removed;
  bool has_other_parts = false;  ///< whether parts were added or removed since the session's construction
  bool renumbered = false;       ///< whether they were since the pipeline was built
  std::function<void(const std::string&)> pass_hook;
  std::vector<Rgb> kept_image;        ///< copy of the last complete image
  mutable std::vector<Rgb> summed;    ///< see mean_of_sums(); empty: not computed
  std::vector<Rgb> replacement;       ///< image that is shown in place of the last complete frame's; empty: none
  std::vector<Rgb> next_replacement;  ///< the same for the frame in progress
  bool in_frame = false;              ///< whether render_frame() runs
  bool shows_kept_image = false;      ///< whether `kept_image` is displayed, because the buffers are empty
  mutable Statistics statistics;
  double image_begun_s = 0;  ///< statistics.render_s when the image began
};

}  // namespace relume
