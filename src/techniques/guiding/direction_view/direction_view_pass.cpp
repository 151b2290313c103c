#include "techniques/guiding/direction_view/direction_view_pass.h"

#include <algorithm>
#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "techniques/guiding/direction_view/incident_light.h"

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

/// Writes an octahedral map into the centre of the left (0) or right (1) half of the layer, unscaled.
template <typename Value>
void draw_map(const FrameContext& frame, uint32_t half, uint32_t edge, const Value& value) {
  const View<float> out = frame.write(kDirections);
  const uint32_t x0 = half * (frame.width() / 2) + (frame.width() / 2 - edge) / 2;
  const uint32_t y0 = (frame.height() - edge) / 2;
  for (uint32_t y = 0; y < edge; ++y) {
    for (uint32_t x = 0; x < edge; ++x) out[(y0 + y) * frame.width() + x0 + x] = value(x, y);
  }
}

}  // namespace

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
  IncidentLightKernel kernel{};
  bool found = false;
  fill(frame.backend, "cdq-view", out, 0.0f);
  frame.backend.run("cdq-view", [&] { found = prepare(frame, pixel, kernel); });
  if (!found) return true;
  kernel.edge = edge;
  if (pixel != pixel_ || sums_.size() != size_t{edge} * edge || frame.since_change == 0)
    sums_.reset(size_t{edge} * edge);
  pixel_ = pixel;
  kernel.sums = sums_.mutable_view();
  frame.launch("cdq-view", kernel, {edge, edge});
  frame.backend.run("cdq-view", [&] { draw(frame, kernel); });
  return true;
}

bool DirectionViewPass::prepare(const FrameContext& frame, uint32_t pixel, IncidentLightKernel& kernel) const {
  const Hit hit = frame.read(kPrimaryHits)[pixel];
  if (!hit.valid()) return false;
  const CameraView& camera = frame.scene.camera;
  Sampler sampler = frame.index.sampler(pixel % frame.width(), pixel / frame.width());
  const Ray ray = camera_ray(camera, pixel % frame.width(), pixel / frame.width(), sampler);
  kernel.context = make_path_context(source_, frame);
  make_surface_point(frame.scene, ray, hit, camera.cone_width() + camera.cone_spread() * hit.t, kernel.point);
  kernel.point.region = octree_.sampled().view().find(kernel.point.previous_position);
  kernel.index = frame.index;
  kernel.index.seed ^= kViewSeed;
  return true;
}

void DirectionViewPass::draw(const FrameContext& frame, const IncidentLightKernel& kernel) const {
  const uint32_t edge = kernel.edge;
  const std::span<const float> sums = sums_.read();
  const auto direction = [&](uint32_t x, uint32_t y) {
    const Vec2 middle(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    return direction_from_square(middle / static_cast<float>(edge));
  };
  const float texel = 1.0f / static_cast<float>(edge * edge);
  double integral = 0;
  for (uint32_t y = 0; y < edge; ++y) {
    for (uint32_t x = 0; x < edge; ++x)
      integral += static_cast<double>(sums[y * edge + x] * octahedral_solid_angle(direction(x, y)) * texel);
  }
  const DirectionalQuadtree tree = source_.directions.quadtrees.load(kernel.point.region);
  draw_map(frame, 0, edge, [&](uint32_t x, uint32_t y) { return tree.pdf(direction(x, y)); });
  draw_map(frame, 1, edge, [&](uint32_t x, uint32_t y) {
    return integral > 0 ? static_cast<float>(static_cast<double>(sums[y * edge + x]) / integral) : 0.0f;
  });
}

void DirectionViewPass::save(std::ostream& out) const {
  write_value(out, pixel_);
  write_array(out, sums_);
}

void DirectionViewPass::load(std::istream& in) {
  uint32_t pixel = 0;
  std::vector<float> sums;
  read_value(in, pixel);
  read_vector(in, sums);
  if (!in) return;
  pixel_ = pixel;
  sums_.assign(sums);  // run() discards sums of another size
}

}  // namespace relume
