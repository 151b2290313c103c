#include "techniques/temporal/reprojection/reprojection_pass.h"

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>
#include <utility>

#include "core/math.h"
#include "core/stream_io.h"
#include "frame/moments.h"
#include "frame/primitives/fill.h"
#include "techniques/temporal/reprojection/backward_buffers.h"
#include "techniques/temporal/reprojection/cells_history.h"
#include "techniques/temporal/reprojection/motion.h"
#include "techniques/temporal/reprojection/reprojection.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {
namespace {

template <typename T>
void move_elements(const FrameContext& frame, Array<uint32_t>& before, Buffer& buffer, const Array<uint32_t>& sources) {
  const View<T> elements = buffer.view_as<T>();
  before.reset(size_t{elements.size} * (sizeof(T) / sizeof(uint32_t)), kUninitialized);
  const View<T> old{reinterpret_cast<T*>(before.mutable_view().data), elements.size};
  copy(frame.backend, "reproject", View<const T>{elements.data, elements.size}, old);
  frame.launch("reproject", MoveKernel<T>{{old.data, old.size}, elements, sources.view(), frame.width()});
}

}  // namespace

ReprojectionPass::ReprojectionPass(const ReprojectionSettings& settings, uint32_t pixel_count,
                                   const HistoryContents& contents, Memory& memory)
    : settings_(settings),
      pixel_count_(pixel_count),
      contents_(contents),
      stored_(memory),
      pixels_(memory),
      stored_before_(memory),
      pixels_before_(memory),
      votes_(memory),
      sources_(memory),
      owned_(memory),
      limits_(memory),
      limits_before_(memory),
      before_(memory) {}

LookBack ReprojectionPass::look_back(const FrameContext& frame) const {
  return {.reprojection = backward_reprojection(frame, kSurface),
          .reject_reasons = frame.read(kHistoryRejectReason),
          .limits = limits_before_.view()};
}

bool ReprojectionPass::fills(const FrameContext& frame) const {
  return settings_.fill && !includes(frame.changes, kMovesScene);
}

bool ReprojectionPass::looks_back() const { return settings_.method == ReprojectionMethod::backward || settings_.fill; }

PassDeclaration ReprojectionPass::declaration() const {
  std::vector<BufferId> reads{kMean, kMoments.m2, kSamples};
  if (looks_back())
    reads.insert(reads.end(), {kSurface.motion, kSurface.previous, kSurface.position, kSurface.normal, kSurface.depth,
                               kSurface.surface});
  const auto shown = [](const BufferId& id, const char* help) {
    return BufferDescription{.id = id, .help = help, .display = BufferDisplay::value};
  };
  const bool forward = settings_.method == ReprojectionMethod::forward;
  std::vector<BufferDescription> owns{
      shown(kHistoryKept, "1 where the pixel continues a history, 0 where it starts one"),
      shown(kHistoryReason,
            forward ? "origin of the pixel's history. 0: none moved here; 1: kept; 10: filled from the old position of "
                      "its surface; 11: kept, but the light of cells is looked up; rejected: 3 occluded, 4 view "
                      "dependent, 5 near specular, 6 several surfaces, 7 relit, 9 on another surface than this frame's "
                      "sample"
                    : "origin of the pixel's history. 0: no samples before; 1: kept; rejected: 2 off screen, 9 another "
                      "surface at the old position")};
  if (forward) {
    owns.push_back(
        shown(kHistoryRejectReason,
              "outcome for the history of the previous frame's pixel, at its old position. 1: kept; 11: kept without "
              "the light of cells; rejected: 2 off screen, 3 occluded, 4 view dependent, 5 near specular, 6 several "
              "surfaces, 7 relit, 8 covered"));
  }
  if (forward) reads.push_back(kPrimaryHits);
  const auto inherited = [](const BufferId& id, const char* help) { return BufferDescription{.id = id, .help = help}; };
  owns.insert(owns.end(), {inherited(kInherited.mean, "reprojected mean, before this frame's sample"),
                           inherited(kInherited.m2, "reprojected m2, before this frame's sample"),
                           inherited(kInherited.samples, "number of reprojected samples, before this frame's sample")});
  if (contents_.cells) {
    owns.push_back(inherited(kInheritedCellsMean, "part of inherited-mean from cells"));
    owns.push_back(inherited(kInheritedCellsSamples, "number of samples in inherited-cells-mean"));
    reads.insert(reads.end(), {kCellsMean, kCellsSamples});
  }
  if (contents_.m2_rgb) owns.push_back(inherited(kInherited.m2_rgb, "reprojected m2-rgb, before this frame's sample"));
  return {.name = "reproject",
          .stage = Stage::history,
          .owns = std::move(owns),
          .reads = std::move(reads),
          .reads_if_any = {kMoments.m2_rgb, kSpecularMean, kInheritedSpecularMean},
          .writes_if_any = {kInherited.m2_rgb, kLightPaths, kCausticMoments.mean, kCausticMoments.m2,
                            kCausticMoments.samples},
          .moves_surfaces = true};
}

bool ReprojectionPass::run(const FrameContext& frame) {
  allocate(frame);
  if (loaded_) drop_unknown(frame);
  loaded_ = false;
  moved_ = false;
  if (!surfaces_move(frame)) {
    stay(frame);
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

void ReprojectionPass::abandon() {
  rests_ = false;
  if (!std::exchange(moved_, false)) return;
  stored_.swap(stored_before_);
  pixels_.swap(pixels_before_);
}

void ReprojectionPass::stay(const FrameContext& frame) {
  move_moments(frame, {});
  if (contents_.cells) {
    copy(frame.backend, "reproject", frame.read(kCellsMean), frame.write(kInheritedCellsMean));
    copy(frame.backend, "reproject", frame.read(kCellsSamples), frame.write(kInheritedCellsSamples));
  }
  const bool ends = frame.number == 0 || includes(frame.changes, kEndsHistory);
  if (ends) {
    relume::fill(frame.backend, "reproject", stored_.mutable_view(), StoredSample{});
    relume::fill(frame.backend, "reproject", pixels_.mutable_view(), StoredPixel{});
  }
  if (ends || !rests_) set_all(frame, !ends);
  rests_ = !ends;
}

void ReprojectionPass::move_moments(const FrameContext& frame, View<const uint32_t> sources) const {
  const MoveMomentsKernel kernel{read_moments(frame, kMoments), write_moments(frame, kInherited), sources,
                                 frame.width()};
  frame.launch("reproject", kernel);
}

void ReprojectionPass::allocate(const FrameContext& frame) {
  if (sources_.size() != frame.pixels()) resize(frame.backend, "reproject", sources_, frame.pixels());
  const bool forward = settings_.method == ReprojectionMethod::forward;  // backward reprojection uses only `sources_`
  const size_t count = forward ? frame.pixels() : 0;
  const uint32_t capacity = forward ? settings_.capacity() : 0;
  if (capacity_ != capacity || pixels_.size() != count) {
    capacity_ = 0;  // until all arrays have their size: allocation may fail
    for (Array<StoredSample>* stored : {&stored_, &stored_before_})
      reset(frame.backend, "reproject", *stored, count * capacity);
    for (Array<StoredPixel>* pixels : {&pixels_, &pixels_before_}) reset(frame.backend, "reproject", *pixels, count);
    capacity_ = capacity;
  }
  if (votes_.size() == count) return;
  for (Array<uint32_t>* limits : {&limits_, &limits_before_}) reset(frame.backend, "reproject", *limits, count);
  owned_.reset(count, kUninitialized);
  votes_.reset(count, kUninitialized);
}

void ReprojectionPass::drop_unknown(const FrameContext& frame) {
  const DropUnknownKernel kernel{frame.scene, stored_.mutable_view(), contents_.light_points};
  frame.launch("reproject", kernel, {static_cast<uint32_t>(stored_.size()), 1, kFillTile});
}

void ReprojectionPass::run_forward(const FrameContext& frame) {
  moved_ = true;
  stored_.swap(stored_before_);
  pixels_.swap(pixels_before_);
  vote_for_pixels(frame);
  take_over(frame);
  move_moments(frame, sources_.view());
  frame.for_each_surface_buffer([&](Buffer& buffer) { move(frame, buffer); });
  if (fills(frame)) fill(frame);
  if (contents_.cells) move_cells(frame);
  mark_covered(frame);
}

/// Moves the elements by `sources_`.
void ReprojectionPass::move(const FrameContext& frame, Buffer& buffer) {
  if (buffer.description().id.type == BufferType::rgb32f) {
    move_elements<Rgb>(frame, before_, buffer, sources_);
  } else {
    move_elements<uint32_t>(frame, before_, buffer, sources_);
  }
}

void ReprojectionPass::vote_for_pixels(const FrameContext& frame) {
  relume::fill(frame.backend, "reproject", votes_.mutable_view(), kNoVote);
  DepthVoteKernel kernel;
  kernel.scene = frame.scene;
  kernel.stored = stored_before_.view();
  kernel.pixels = pixels_before_.view();
  kernel.votes = votes_.mutable_view();
  kernel.reject_reasons = frame.write(kHistoryRejectReason);
  kernel.mean = frame.read(kMean);
  kernel.limits = limits_before_.mutable_view();
  kernel.max_samples_changed = static_cast<uint32_t>(settings_.max_samples_changed);
  kernel.capacity = capacity_;
  kernel.max_error = settings_.error;
  kernel.max_light_error = settings_.light_error;
  kernel.exposure = math::exp2(settings_.exposure);
  kernel.lights_changed = includes(frame.changes, kMovesScene);
  kernel.light_points = contents_.light_points;
  kernel.splats_apart = contents_.splats_apart;
  kernel.indirect_apart = contents_.indirect_apart;
  kernel.seed = hash(frame.index.seed, frame.number);
  kernel.width = frame.width();
  frame.launch("reproject", kernel);
}

void ReprojectionPass::take_over(const FrameContext& frame) {
  SourceKernel source;
  source.votes = votes_.view();
  source.stored_before = stored_before_.view();
  source.pixels_before = pixels_before_.view();
  source.stored = stored_.mutable_view();
  source.pixels = pixels_.mutable_view();
  source.limits_before = limits_before_.view();
  source.limits = limits_.mutable_view();
  source.sources = sources_.mutable_view();
  source.kept = frame.write(kHistoryKept);
  source.reasons = frame.write(kHistoryReason);
  if (fills(frame)) source.look_back = look_back(frame);
  source.scene = frame.scene;
  source.hits = frame.read(kPrimaryHits);
  source.max_distance = settings_.max_distance;
  source.capacity = capacity_;
  source.width = frame.width();
  frame.launch("reproject", source);
}

void ReprojectionPass::mark_covered(const FrameContext& frame) {
  relume::fill(frame.backend, "reproject", owned_.mutable_view(), 0u);
  const OwnerKernel owner{sources_.view(), owned_.mutable_view(), frame.width()};
  frame.launch("reproject", owner);
  const CoveredKernel covered{owned_.view(), frame.write(kHistoryRejectReason), frame.width()};
  frame.launch("reproject", covered);
}

void ReprojectionPass::fill(const FrameContext& frame) const {
  FillKernel kernel;
  kernel.look_back = look_back(frame);
  kernel.reasons = frame.read(kHistoryReason);
  kernel.history = {.before = read_moments(frame, kMoments), .now = write_moments(frame, kInherited)};
  kernel.width = frame.width();
  frame.launch("reproject", kernel);
}

/// Before mark_covered(), which changes the reasons of the previous frame's pixels.
void ReprojectionPass::move_cells(const FrameContext& frame) const {
  CellsHistoryKernel kernel;
  if (fills(frame)) kernel.look_back = look_back(frame);
  kernel.sources = sources_.view();
  kernel.reasons = frame.read(kHistoryReason);
  kernel.limits = limits_.view();
  kernel.before = frame.read(kCellsMean);
  kernel.samples_before = frame.read(kCellsSamples);
  kernel.mean = frame.write(kInherited.mean);
  kernel.now = frame.write(kInheritedCellsMean);
  kernel.samples = frame.write(kInheritedCellsSamples);
  kernel.max_samples = history_limit(frame, settings_);
  kernel.width = frame.width();
  frame.launch("reproject", kernel);
}

void ReprojectionPass::run_backward(const FrameContext& frame) {
  BackwardHistoryKernel kernel;
  kernel.reprojection = backward_reprojection(frame, kSurface);
  kernel.history = {.before = read_moments(frame, kMoments),
                    .now = write_moments(frame, kInherited),
                    .specular_before = frame.read(kSpecularMean),
                    .specular = frame.read(kInheritedSpecularMean)};
  kernel.sources = sources_.mutable_view();
  kernel.kept = frame.write(kHistoryKept);
  kernel.reasons = frame.write(kHistoryReason);
  frame.launch("reproject", kernel);
  frame.for_each_surface_buffer([&](Buffer& buffer) { move(frame, buffer); });
}

void ReprojectionPass::limit(const FrameContext& frame) const {
  LimitKernel kernel;
  kernel.moments = write_moments(frame, kInherited);
  if (settings_.method == ReprojectionMethod::forward) kernel.limits = limits_.view();
  kernel.max_samples = history_limit(frame, settings_);
  kernel.light_paths = frame.write(kLightPaths);
  kernel.caustics = {.mean = frame.write(kCausticMoments.mean),
                     .m2 = frame.write(kCausticMoments.m2),
                     .m2_rgb = {},
                     .samples = frame.write(kCausticMoments.samples)};
  kernel.width = frame.width();
  frame.launch("reproject", kernel);
}

void ReprojectionPass::set_all(const FrameContext& frame, bool kept) const {
  static_assert(static_cast<uint32_t>(RejectReason::empty) == 0 &&
                static_cast<uint32_t>(RejectReason::none) == 1);  // values in the three buffers
  const auto set = [&](const BufferKey<uint32_t>& key) {
    relume::fill(frame.backend, "reproject", frame.write(key), kept ? 1u : 0u);
  };
  set(kHistoryKept);
  set(kHistoryReason);
  if (settings_.method == ReprojectionMethod::forward) set(kHistoryRejectReason);
}

size_t ReprojectionPass::memory_bytes() const {
  return 2 * (stored_.size() * sizeof(StoredSample) + pixels_.size() * sizeof(StoredPixel)) +
         votes_.size() * (sizeof(uint64_t) + 3 * sizeof(uint32_t)) + sources_.size() * sizeof(uint32_t) +
         before_.memory_bytes();
}

void ReprojectionPass::save(std::ostream& out) const {
  write_array(out, stored_);
  write_array(out, pixels_);
}

void ReprojectionPass::load(std::istream& in) {
  // Buffers that the next frame overwrites: a failed load changes nothing.
  read_array(in, stored_before_);
  read_array(in, pixels_before_);
  const size_t stored = stored_before_.size();
  const bool nothing = stored == 0 && pixels_before_.empty();  // saved before the first frame, or backward
  const size_t capacity = stored / pixel_count_;  // not settings_.capacity() if that changed after the last frame
  if (!nothing && (pixels_before_.size() != pixel_count_ || stored != capacity * pixel_count_ || capacity < 1 ||
                   capacity > kMaxStoredSamples))
    in.setstate(std::ios::failbit);
  if (!in) return;
  stored_ = stored_before_;
  pixels_ = pixels_before_;
  loaded_ = true;
  capacity_ = static_cast<uint32_t>(capacity);
}

PassDeclaration StoreSamplesPass::declaration() const {
  return {.name = "store",
          .stage = Stage::present,
          .reads = {kPrimaryHits, kFirstVertices, kRadiance},
          .writes = {kInherited.mean, kInherited.m2, kInherited.samples},
          .reads_if_any = {kAllocation, kEdgeRays, kCellsAtHit},
          .writes_if_any = {kInherited.m2_rgb},
          .only_sampled_pixels = true};
}

bool StoreSamplesPass::run(const FrameContext& frame) {
  StoreKernel kernel;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.first_vertices = frame.read(kFirstVertices);
  kernel.allocation = frame.read(kAllocation);
  kernel.edge_rays = frame.read(kEdgeRays);
  kernel.cells = frame.read(kCellsAtHit);
  kernel.radiance = frame.read(kRadiance);
  kernel.history = write_moments(frame, kInherited);
  kernel.restarts = frame.ends_pilot;
  kernel.scene = frame.scene;
  kernel.stored = history_.stored();
  kernel.pixels = history_.pixels();
  kernel.capacity = history_.capacity();
  kernel.max_distance = settings_.max_distance;
  kernel.width = frame.width();
  frame.launch("store", kernel);
  return true;
}

}  // namespace relume
