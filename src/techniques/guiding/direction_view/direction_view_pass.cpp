#include "techniques/guiding/direction_view/direction_view_pass.h"

#include <algorithm>
#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/reduce.h"
#include "techniques/guiding/direction_view/direction_maps.h"

namespace relume {
namespace {

/// Makes random numbers independent of the image's.
constexpr uint32_t kViewSeed = 0x7f4a7c15u;

uint32_t chosen_pixel(const DirectionalQuadtreeSettings& s, const FrameContext& frame) {
  const auto place = [](float share, uint32_t size) {
    return std::min(static_cast<uint32_t>(share * static_cast<float>(size)), size - 1);
  };
  return place(s.view_y, frame.height()) * frame.width() + place(s.view_x, frame.width());
}

}  // namespace

DirectionViewPass::DirectionViewPass(const DirectionalQuadtreeSettings& settings, const PathSource& source,
                                     const OctreePass& octree, Memory& memory)
    : settings_(settings), source_(source), octree_(octree), point_(memory), sums_(memory) {}

PassDeclaration DirectionViewPass::declaration() const {
  return {.name = "cdq-view",
          .stage = Stage::present,
          .owns = {{.id = kDirections,
                    .help = "with cdq.view: guiding density at one point over the sphere of directions, per steradian, "
                            "beside the density of the light that arrives there",
                    .display = BufferDisplay::value}},
          .reads = {kPrimaryHits}};
}

bool DirectionViewPass::run(const FrameContext& frame) {
  const uint32_t edge = std::min(frame.width() / 2, frame.height());
  const View<float> out = frame.write(kDirections);
  if (!settings_.view || edge == 0) {
    if (!sums_.empty()) fill(frame.backend, "cdq-view", out, 0.0f);  // the last frame's view
    sums_.clear();
    return true;
  }
  const uint32_t pixel = chosen_pixel(settings_, frame);
  fill(frame.backend, "cdq-view", out, 0.0f);
  if (!find_point(frame, pixel)) return true;
  if (pixel != pixel_ || sums_.size() != size_t{edge} * edge || frame.since_change == 0)
    reset(frame.backend, "cdq-view", sums_, size_t{edge} * edge);
  pixel_ = pixel;
  trace(frame, edge);
  draw(frame, edge);
  return true;
}

bool DirectionViewPass::find_point(const FrameContext& frame, uint32_t pixel) {
  point_.reset(1, kUninitialized);
  const FindViewedPointKernel find{.scene = frame.scene,
                                   .index = frame.index,
                                   .octree = octree_.sampled().view(),
                                   .hits = frame.read(kPrimaryHits),
                                   .pixel = pixel,
                                   .width = frame.width(),
                                   .point = point_.mutable_view()};
  frame.launch("cdq-view", find, {1, 1});
  return point_.read()[0].hit.valid();
}

void DirectionViewPass::trace(const FrameContext& frame, uint32_t edge) {
  IncidentLightKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.viewed = point_.view();
  kernel.index = frame.index;
  kernel.index.seed ^= kViewSeed;
  kernel.edge = edge;
  kernel.sums = sums_.mutable_view();
  frame.launch("cdq-view", kernel, {edge, edge});
}

void DirectionViewPass::draw(const FrameContext& frame, uint32_t edge) {
  const TexelIntegrals texels{sums_.view(), edge};
  const double integral = reduce<Sum<double>>({frame.backend, "cdq-view", scratch_}, texels, edge * edge);
  const DrawDirectionMapsKernel maps{.quadtrees = source_.directions.quadtrees,
                                     .point = point_.view(),
                                     .sums = sums_.view(),
                                     .integral = integral,
                                     .edge = edge,
                                     .width = frame.width(),
                                     .height = frame.height(),
                                     .out = frame.write(kDirections)};
  frame.launch("cdq-view", maps, {2, edge});
}

void DirectionViewPass::save(std::ostream& out) const {
  write_value(out, pixel_);
  write_array(out, sums_);
}

void DirectionViewPass::load(std::istream& in) {
  uint32_t pixel = 0;
  Array<float> sums(sums_.memory());
  read_value(in, pixel);
  read_array(in, sums);  // run() discards sums of another size
  if (!in) return;
  pixel_ = pixel;
  sums_ = std::move(sums);
}

}  // namespace relume
