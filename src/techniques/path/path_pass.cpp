#include "techniques/path/path_pass.h"

#include "techniques/path/recorded_path.h"

namespace relume {

std::vector<BufferDescription> estimator_buffers() {
  return {{.name = "radiance",
           .type = BufferType::rgb32f,
           .help = "radiance of this frame's sample",
           .display = BufferDisplay::value},
          {.name = "rays",
           .type = BufferType::u32,
           .help = "rays traced for this frame's sample",
           .display = BufferDisplay::value}};
}

PathContext make_path_context(const PathSource& source, const FrameContext& frame) {
  PathContext context;
  context.scene = frame.scene;
  context.selector = source.selector;
  context.directions = source.directions;
  context.max_bounces = static_cast<uint32_t>(source.settings.max_bounces);
  context.russian_roulette = source.settings.russian_roulette;
  return context;
}

PassDeclaration PathPass::declaration() const {
  PassDeclaration declaration{.name = "trace",
                              .stage = Stage::trace,
                              .owns = estimator_buffers(),
                              .reads = {"primary-hits"},
                              .reads_if_any = {"allocation"}};
  if (first_vertices_) {
    declaration.owns.push_back({.name = "first-vertices",
                                .type = BufferType::record,
                                .help = "directions and light of this frame's sample at its first vertex",
                                .record_bytes = sizeof(FirstVertex)});
  }
  return declaration;
}

bool PathPass::run(const FrameContext& frame) {
  PathKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.index = frame.index;
  kernel.hits = frame.view<const Hit>("primary-hits");
  kernel.allocation = frame.view<const uint32_t>("allocation");
  kernel.radiance = frame.view<Rgb>("radiance");
  kernel.rays = frame.view<uint32_t>("rays");
  kernel.width = frame.width();
  const View<FirstVertex> vertices = first_vertices_ ? frame.view<FirstVertex>("first-vertices") : View<FirstVertex>{};
  if (recording_) {
    return frame.launch("trace", RecordedPathKernel{kernel.context, kernel.index, kernel.hits, kernel.allocation,
                                                    kernel.radiance, kernel.rays, *recording_, vertices, kernel.width});
  }
  if (!first_vertices_) return frame.launch("trace", kernel);
  return frame.launch("trace", FirstVertexPathKernel{kernel, vertices});
}

}  // namespace relume
