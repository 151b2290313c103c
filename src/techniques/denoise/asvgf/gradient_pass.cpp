#include "techniques/denoise/asvgf/gradient_pass.h"

#include <istream>
#include <ostream>
#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "techniques/denoise/shared/denoiser_buffers.h"

namespace relume {
namespace {

/// Edge of the square of strata per task: each traces a path.
constexpr uint32_t kTasks = 8;

}  // namespace

PassDeclaration GradientPass::declaration() const {
  return {.name = "asvgf-gradients",
          .stage = Stage::trace,
          .reads = {kPrimaryHits, kRadiance},
          .writes = {kRays},
          .reads_if_any = {kAllocation},
          .only_sampled_pixels = true};
}

bool GradientPass::run(const FrameContext& frame) {
  exchanged_ = false;
  const size_t count = size_t{strata(frame.width())} * strata(frame.height());
  const Recording& before = recorded_[current_];
  Recording& now = recorded_[current_ ^ 1u];
  traced_ = may_differ(frame) && before.numbers.valid != 0 && before.samples.size() == count;
  if (traced_ && !trace(frame, before)) return false;
  now.samples.reset(count, kUninitialized);
  if (!record(frame, now)) return false;
  now.numbers = {.seed = frame.index.seed,
                 .sequence = frame.index.sequence,
                 .frame = frame.index.frame,
                 .age = frame.index.age,
                 .camera_runs = frame.index.runs_through() ? 1u : 0u,
                 .valid = 1};
  current_ ^= 1u;
  exchanged_ = true;
  return true;
}

bool GradientPass::may_differ(const FrameContext& frame) const {
  if (frame.number == 0 || includes(frame.changes, kEndsDenoiserHistory)) return false;
  const Change view = settings_.view_changes ? Change::camera : Change::none;
  return includes(frame.changes, Change::geometry | Change::lights | view);
}

void GradientPass::abandon() {
  if (std::exchange(exchanged_, false)) current_ ^= 1u;
}

bool GradientPass::trace(const FrameContext& frame, const Recording& before) {
  const uint32_t columns = strata(frame.width());
  const uint32_t rows = strata(frame.height());
  votes_.reset(before.samples.size(), kUninitialized);
  gradients_.reset(before.samples.size(), kUninitialized);
  fill(frame.backend, "asvgf-project", votes_.mutable_view(), kNoVote);
  ProjectSamplesKernel project;
  project.scene = frame.scene;
  project.samples = before.samples.view();
  project.votes = votes_.mutable_view();
  project.columns = columns;
  project.width = frame.width();
  project.height = frame.height();
  if (!frame.launch_or_stop("asvgf-project", project, {columns, rows})) return false;

  TraceGradientsKernel kernel;
  kernel.index = {.seed = before.numbers.seed,
                  .sequence = before.numbers.sequence,
                  .frame = before.numbers.frame,
                  .age = before.numbers.age,
                  .camera_runs = before.numbers.camera_runs != 0,
                  .tile = frame.index.tile};
  kernel.context = make_path_context(source_, frame);
  kernel.context.indirect = indirect_rate(source_.settings.indirect_rate, kernel.index, frame.blue_noise);
  kernel.camera = frame.scene.camera;
  kernel.same_view = !settings_.view_changes || same_view(frame.scene.camera, frame.scene.previous_camera);
  if (!settings_.view_changes) kernel.context.scene.camera = frame.scene.previous_camera;
  kernel.samples = before.samples.view();
  kernel.votes = votes_.view();
  kernel.gradients = gradients_.mutable_view();
  kernel.rays = frame.write(kRays);
  kernel.columns = columns;
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-trace", kernel, {columns, rows, kTasks});
}

bool GradientPass::record(const FrameContext& frame, Recording& now) const {
  RecordSamplesKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.radiance = frame.read(kRadiance);
  kernel.allocation = frame.read(kAllocation);
  kernel.samples = now.samples.mutable_view();
  kernel.columns = strata(frame.width());
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("asvgf-record", kernel, {kernel.columns, strata(frame.height())});
}

size_t GradientPass::memory_bytes() const {
  return recorded_[0].samples.memory_bytes() + recorded_[1].samples.memory_bytes() + votes_.memory_bytes() +
         gradients_.memory_bytes();
}

void GradientPass::save(std::ostream& out) const {
  write_value(out, recorded_[current_].numbers);
  write_array(out, recorded_[current_].samples);
}

void GradientPass::load(std::istream& in) {
  Recording& last = recorded_[current_];
  read_value(in, last.numbers);
  read_array(in, last.samples);
  if (!in) last.numbers = {};
}

}  // namespace relume
