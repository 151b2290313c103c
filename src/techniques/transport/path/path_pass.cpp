#include "techniques/transport/path/path_pass.h"

#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/recorded_path.h"
#include "techniques/transport/path/specular_part.h"
#include "techniques/transport/path/trace_paths.h"

namespace relume {

std::vector<BufferDescription> estimator_buffers() {
  return {{.id = kRadiance, .help = "radiance of this frame's sample", .display = BufferDisplay::value},
          {.id = kRays, .help = "rays traced for this frame's sample", .display = BufferDisplay::value}};
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
                              .reads = {kPrimaryHits},
                              .reads_if_any = {kAllocation},
                              .only_sampled_pixels = true};
  if (outputs_.first_vertices) {
    declaration.owns.push_back(
        {.id = kFirstVertices, .help = "directions and light of this frame's sample at its first vertex"});
  }
  if (outputs_.specular) {
    declaration.owns.push_back({.id = kRadianceSpecular,
                                .help = "the part of radiance that specular lobes of the first surface scattered",
                                .display = BufferDisplay::value});
  }
  return declaration;
}

template <typename Observation>
bool PathPass::trace(const FrameContext& frame, const Observation& observation) const {
  if (!outputs_.specular) return trace_paths(source_, frame, observation);
  return trace_paths(source_, frame, SpecularObservation<Observation>{observation, frame.write(kRadianceSpecular)});
}

bool PathPass::run(const FrameContext& frame) {
  const View<Rgb> radiance = frame.write(kRadiance);
  View<FirstVertex> vertices;
  if (outputs_.first_vertices) vertices = frame.write(kFirstVertices);
  if (recording_) return trace(frame, RecordingObservation{radiance, *recording_, vertices});
  if (outputs_.first_vertices) return trace(frame, FirstVertexObservation{radiance, vertices});
  return trace(frame, RadianceObservation{radiance});
}

}  // namespace relume
