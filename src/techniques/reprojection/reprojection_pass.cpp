#include "techniques/reprojection/reprojection_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <istream>
#include <iterator>
#include <optional>
#include <ostream>

#include "core/stream_io.h"
#include "techniques/reprojection/backward_buffers.h"
#include "techniques/reprojection/reprojection.h"

namespace relume {
namespace {

/// What a surface that moves takes along. Materials and settings are another matter: then everything starts anew.
constexpr Change kMoves = Change::camera | Change::geometry | Change::lights;
constexpr Change kEnds = Change::materials | Change::settings;

/// Changes of indirect light. No validation covers it, so it lags in every kept history.
constexpr Change kMovesScene = Change::geometry | Change::lights;

constexpr SurfaceBuffers kSurface{.motion = "surface-motion",
                                  .previous = "surface-previous",
                                  .position = "surface-position",
                                  .normal = "surface-normal",
                                  .depth = "surface-depth",
                                  .surface = "surface-instance"};

template <typename T>
void move_elements(const FrameContext& frame, std::vector<std::byte>& before, const Buffer& buffer,
                   const std::vector<uint32_t>& sources) {
  const auto bytes = buffer.bytes();
  before.assign(bytes.begin(), bytes.end());
  const View<const T> old{reinterpret_cast<const T*>(before.data()), frame.pixels()};
  launch(frame.backend, "reproject", MoveKernel<T>{old, buffer.view<T>(), view_of(sources), frame.width()},
         frame.width(), frame.height());
}

/// Whether kernels may look the sample up in the scene.
bool exists_in(const SceneView& scene, const StoredSample& sample) {
  const auto in_unit_interval = [](float x) { return x >= 0.0f && x < 1.0f; };
  const Hit& hit = sample.hit;
  return hit.instance < scene.instances.size &&
         hit.primitive < scene.meshes[scene.instances[hit.instance].mesh].triangle_count && std::isfinite(hit.u) &&
         std::isfinite(hit.v) && in_unit_interval(sample.light_u.x) && in_unit_interval(sample.light_u.y);
}

}  // namespace

/// Copies of the buffers that are interpolated, as the frame before left them.
class ReprojectionPass::HistoryBuffers {
 public:
  explicit HistoryBuffers(const FrameContext& frame)
      : mean_(copy(frame.view<Rgb>("mean"))),
        m2_(copy(frame.view<float>("m2"))),
        m2_rgb_(copy(frame.view<Rgb>("adaptive-m2"))),
        samples_(copy(frame.view<uint32_t>("samples"))) {}

  InterpolatedHistory interpolated(const FrameContext& frame) const {
    return {.mean_before = view_of(mean_),
            .m2_before = view_of(m2_),
            .m2_rgb_before = view_of(m2_rgb_),
            .samples_before = view_of(samples_),
            .mean = frame.view<Rgb>("mean"),
            .m2 = frame.view<float>("m2"),
            .m2_rgb = frame.view<Rgb>("adaptive-m2"),
            .samples = frame.view<uint32_t>("samples")};
  }

 private:
  template <typename T>
  static std::vector<T> copy(const View<T>& view) {
    return {view.begin(), view.end()};
  }

  std::vector<Rgb> mean_;
  std::vector<float> m2_;
  std::vector<Rgb> m2_rgb_;
  std::vector<uint32_t> samples_;
};

LookBack ReprojectionPass::look_back(const FrameContext& frame) const {
  return {.reprojection = backward_reprojection(frame, kSurface),
          .fates = frame.view<const uint32_t>("history-fate"),
          .limits = view_of(limits_before_)};
}

bool ReprojectionPass::fills(const FrameContext& frame) const {
  return settings_.fill && !includes(frame.changes, kMovesScene);
}

bool ReprojectionPass::looks_back() const { return settings_.method == ReprojectionMethod::backward || settings_.fill; }

PassDeclaration ReprojectionPass::declaration() const {
  std::vector<std::string_view> reads{"mean", "m2", "samples"};
  if (looks_back())
    reads.insert(reads.end(), {"surface-motion", "surface-previous", "surface-position", "surface-normal",
                               "surface-depth", "surface-instance"});
  const auto shown = [](const char* name, const char* help) {
    return BufferDescription{.name = name, .type = BufferType::u32, .help = help, .display = BufferDisplay::value};
  };
  const bool forward = settings_.method == ReprojectionMethod::forward;
  std::vector<BufferDescription> owns{
      shown("history-kept", "1 where this frame's pixel continues a history, 0 where it starts one"),
      shown("history-reason",
            forward
                ? "why, of this frame's pixel: 1 kept, 10 filled from where its surface was, 0 nothing came to "
                  "lie here; what did was 3 occluded, 4 view dependent, 5 near specular, 6 several surfaces, 7 relit, "
                  "9 another surface than this frame's sample hit"
                : "why, of this frame's pixel: 1 kept, 0 nothing was known, 2 it was off screen, 9 "
                  "another surface was seen where it was")};
  if (forward) {
    owns.push_back(
        shown("history-fate",
              "what became of the pixel of the frame before, where it was: 1 kept, 2 off screen, 3 occluded, "
              "4 view dependent, 5 near specular, 6 several surfaces, 7 relit, 8 covered"));
  }
  if (forward) reads.push_back("primary-hits");
  return {.name = "reproject",
          .stage = Stage::history,
          .owns = std::move(owns),
          .reads = std::move(reads),
          .writes = {"mean", "m2", "samples"},
          .writes_if_any = {"adaptive-m2", "light-paths"},
          .moves_surfaces = true};
}

bool ReprojectionPass::run(const FrameContext& frame) {
  allocate(frame);
  if (loaded_) drop_unknown(frame.scene);
  loaded_ = false;
  if (includes(frame.changes, kEnds) || frame.number == 0) {
    std::fill(stored_.begin(), stored_.end(), StoredSample{});
    std::fill(pixels_.begin(), pixels_.end(), StoredPixel{});
    tell_all(frame, false);
    rests_ = false;
    return true;
  }
  if (!includes(frame.changes, kMoves)) {
    if (!rests_) tell_all(frame, true);
    rests_ = true;
    return true;
  }
  rests_ = false;
  if (settings_.method == ReprojectionMethod::forward) {
    run_forward(frame);
  } else {
    run_backward(frame);
  }
  limit(frame);
  return true;
}

void ReprojectionPass::allocate(const FrameContext& frame) {
  sources_.resize(frame.pixels());
  const bool forward = settings_.method == ReprojectionMethod::forward;  // backward, nobody reads the rest
  const size_t count = forward ? frame.pixels() : 0;
  const uint32_t capacity = forward ? settings_.capacity() : 0;
  if (capacity_ == capacity && pixels_.size() == count) return;
  capacity_ = capacity;
  stored_.assign(count * capacity_, StoredSample{});
  pixels_.assign(count, StoredPixel{});
  stored_before_ = stored_;
  pixels_before_ = pixels_;
  claims_.resize(count);
  winners_.resize(count);
  limits_.resize(count);
  limits_before_.resize(count);
}

void ReprojectionPass::drop_unknown(const SceneView& scene) {
  for (StoredSample& sample : stored_) {
    if (sample.valid() && !exists_in(scene, sample)) sample = StoredSample{};
  }
}

void ReprojectionPass::run_forward(const FrameContext& frame) {
  stored_.swap(stored_before_);
  pixels_.swap(pixels_before_);
  claim_places(frame);
  take_over(frame);
  std::optional<HistoryBuffers> before;
  if (fills(frame)) before.emplace(frame);
  frame.for_each_surface_buffer([&](const Buffer& buffer) { move(frame, buffer); });
  if (before) fill(frame, *before);
  note_covered(frame);
}

/// From `sources_`.
void ReprojectionPass::move(const FrameContext& frame, const Buffer& buffer) {
  if (buffer.description().type == BufferType::rgb32f) {
    move_elements<Rgb>(frame, before_, buffer, sources_);
  } else {
    move_elements<uint32_t>(frame, before_, buffer, sources_);
  }
}

void ReprojectionPass::claim_places(const FrameContext& frame) {
  std::fill(claims_.begin(), claims_.end(), kNoClaim);
  ClaimKernel claim;
  claim.scene = frame.scene;
  claim.stored = view_of(stored_before_);
  claim.pixels = view_of(pixels_before_);
  claim.claims = mutable_view_of(claims_);
  claim.fates = frame.view<uint32_t>("history-fate");
  claim.mean = frame.view<const Rgb>("mean");
  claim.limits = mutable_view_of(limits_before_);
  claim.max_samples_changed = static_cast<uint32_t>(settings_.max_samples_changed);
  claim.capacity = capacity_;
  claim.max_error = settings_.error;
  claim.max_light_error = settings_.light_error;
  claim.exposure = std::exp2(settings_.exposure);
  claim.lights_changed = includes(frame.changes, kMovesScene);
  claim.seed = hash(frame.index.seed, frame.number);
  claim.width = frame.width();
  launch(frame.backend, "reproject", claim, frame.width(), frame.height());
}

void ReprojectionPass::take_over(const FrameContext& frame) {
  SourceKernel source;
  source.claims = view_of(claims_);
  source.stored_before = view_of(stored_before_);
  source.pixels_before = view_of(pixels_before_);
  source.stored = mutable_view_of(stored_);
  source.pixels = mutable_view_of(pixels_);
  source.limits_before = view_of(limits_before_);
  source.limits = mutable_view_of(limits_);
  source.sources = mutable_view_of(sources_);
  source.kept = frame.view<uint32_t>("history-kept");
  source.reasons = frame.view<uint32_t>("history-reason");
  if (fills(frame)) source.look_back = look_back(frame);
  source.scene = frame.scene;
  source.hits = frame.view<const Hit>("primary-hits");
  source.max_distance = settings_.max_distance;
  source.capacity = capacity_;
  source.width = frame.width();
  launch(frame.backend, "reproject", source, frame.width(), frame.height());
}

void ReprojectionPass::note_covered(const FrameContext& frame) {
  std::fill(winners_.begin(), winners_.end(), 0u);
  const WinnerKernel winner{view_of(sources_), mutable_view_of(winners_), frame.width()};
  launch(frame.backend, "reproject", winner, frame.width(), frame.height());
  const CoveredKernel covered{view_of(winners_), frame.view<uint32_t>("history-fate"), frame.width()};
  launch(frame.backend, "reproject", covered, frame.width(), frame.height());
}

void ReprojectionPass::fill(const FrameContext& frame, const HistoryBuffers& before) const {
  FillKernel kernel;
  kernel.look_back = look_back(frame);
  kernel.reasons = frame.view<const uint32_t>("history-reason");
  kernel.history = before.interpolated(frame);
  kernel.width = frame.width();
  launch(frame.backend, "reproject", kernel, frame.width(), frame.height());
}

void ReprojectionPass::run_backward(const FrameContext& frame) {
  const HistoryBuffers before(frame);
  BackwardHistoryKernel kernel;
  kernel.reprojection = backward_reprojection(frame, kSurface);
  kernel.history = before.interpolated(frame);
  kernel.sources = mutable_view_of(sources_);
  kernel.kept = frame.view<uint32_t>("history-kept");
  kernel.reasons = frame.view<uint32_t>("history-reason");
  launch(frame.backend, "reproject", kernel, frame.width(), frame.height());
  constexpr std::string_view kMoved[] = {"mean", "m2", "adaptive-m2", "samples"};
  frame.for_each_surface_buffer([&](const Buffer& buffer) {
    if (std::find(std::begin(kMoved), std::end(kMoved), buffer.description().name) == std::end(kMoved))
      move(frame, buffer);
  });
}

void ReprojectionPass::limit(const FrameContext& frame) const {
  const bool scene_moved = includes(frame.changes, kMovesScene);
  LimitKernel kernel;
  kernel.samples = frame.view<uint32_t>("samples");
  kernel.m2 = frame.view<float>("m2");
  kernel.m2_rgb = frame.view<Rgb>("adaptive-m2");
  if (settings_.method == ReprojectionMethod::forward) kernel.limits = view_of(limits_);
  kernel.max_samples = static_cast<uint32_t>(scene_moved ? settings_.max_samples_changed : settings_.max_samples);
  kernel.light_paths = frame.view<float>("light-paths");
  kernel.width = frame.width();
  launch(frame.backend, "reproject", kernel, frame.width(), frame.height());
}

void ReprojectionPass::tell_all(const FrameContext& frame, bool kept) const {
  static_assert(static_cast<uint32_t>(ReprojectionFate::empty) == 0 &&
                static_cast<uint32_t>(ReprojectionFate::kept) == 1);  // what is kept, why, and what became of it
  for (const BufferDescription& buffer : declaration().owns) {
    const View<uint32_t> values = frame.view<uint32_t>(buffer.name);
    std::fill(values.begin(), values.end(), kept ? 1u : 0u);
  }
}

size_t ReprojectionPass::memory_bytes() const {
  return 2 * (stored_.size() * sizeof(StoredSample) + pixels_.size() * sizeof(StoredPixel)) +
         claims_.size() * (sizeof(uint64_t) + 3 * sizeof(uint32_t)) + sources_.size() * sizeof(uint32_t) +
         before_.capacity();
}

void ReprojectionPass::save(std::ostream& out) const {
  write_vector(out, stored_);
  write_vector(out, pixels_);
}

void ReprojectionPass::load(std::istream& in) {
  // Whatever goes wrong, the next frame overwrites these.
  read_vector(in, stored_before_);
  read_vector(in, pixels_before_);
  const size_t stored = stored_before_.size();
  const bool nothing = stored == 0 && pixels_before_.empty();  // saved before the first frame, or backward
  const size_t capacity = stored / pixel_count_;  // not settings_.capacity() if that has changed since a frame
  if (!nothing && (pixels_before_.size() != pixel_count_ || stored != capacity * pixel_count_ || capacity < 1 ||
                   capacity > kMaxStoredSamples))
    in.setstate(std::ios::failbit);
  if (!in) return;
  stored_ = stored_before_;
  pixels_ = pixels_before_;
  loaded_ = true;
  capacity_ = static_cast<uint32_t>(capacity);
  claims_.resize(pixels_.size());
  winners_.resize(pixels_.size());
  limits_.resize(pixels_.size());
  limits_before_.resize(pixels_.size());
}

PassDeclaration StoreSamplesPass::declaration() const {
  return {.name = "store",
          .stage = Stage::present,
          .reads = {"primary-hits", "first-vertices", "radiance"},
          .writes = {"mean", "m2", "samples"},
          .reads_if_any = {"allocation", "edge-rays"},
          .writes_if_any = {"adaptive-m2"}};
}

bool StoreSamplesPass::run(const FrameContext& frame) {
  StoreKernel kernel;
  kernel.hits = frame.view<const Hit>("primary-hits");
  kernel.first_vertices = frame.view<const FirstVertex>("first-vertices");
  kernel.allocation = frame.view<const uint32_t>("allocation");
  kernel.edge_rays = frame.view<const uint32_t>("edge-rays");
  kernel.radiance = frame.view<const Rgb>("radiance");
  kernel.samples = frame.view<uint32_t>("samples");
  kernel.mean = frame.view<Rgb>("mean");
  kernel.m2 = frame.view<float>("m2");
  kernel.m2_rgb = frame.view<Rgb>("adaptive-m2");
  kernel.scene = frame.scene;
  kernel.stored = mutable_view_of(history_.stored());
  kernel.pixels = mutable_view_of(history_.pixels());
  kernel.capacity = history_.capacity();
  kernel.max_distance = settings_.max_distance;
  kernel.width = frame.width();
  return launch(frame.backend, "store", kernel, frame.width(), frame.height());
}

}  // namespace relume
