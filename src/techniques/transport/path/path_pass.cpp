#include "techniques/transport/path/path_pass.h"

#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/specular_part.h"
#include "techniques/transport/path/trace_paths.h"

namespace relume {

std::vector<BufferDescription> estimator_buffers() {
  return {{.id = kRadiance, .help = "radiance of this frame's sample", .display = BufferDisplay::value},
          {.id = kRays, .help = "number of rays traced for this frame's sample", .display = BufferDisplay::value}};
}

PathContext make_path_context(const PathSource& source, const FrameContext& frame) {
  PathContext context;
  context.scene = frame.scene;
  context.selector = source.selector;
  context.directions = source.directions;
  context.max_bounces = static_cast<uint32_t>(source.settings.max_bounces);
  context.russian_roulette = source.settings.russian_roulette;
  context.indirect = indirect_rate(source.settings.indirect_rate, frame.index);
  return context;
}

PassDeclaration PathPass::declaration() const {
  PassDeclaration declaration{.name = "trace",
                              .stage = Stage::trace,
                              .owns = estimator_buffers(),
                              .reads = {kPrimaryHits},
                              .reads_if_any = {kAllocation},
                              .only_sampled_pixels = true};
  if (records_.first_vertices) {
    declaration.owns.push_back(
        {.id = kFirstVertices,
         .help = "sampled directions and their light at the first vertex of this frame's sample"});
  }
  if (records_.specular) {
    declaration.owns.push_back({.id = kRadianceSpecular,
                                .help = "part of radiance scattered by specular lobes of the first surface",
                                .display = BufferDisplay::value});
  }
  return declaration;
}

namespace {

// Each combination of outputs has its own kernel, so unread outputs cost nothing.

template <typename... Outputs>
bool trace_with_specular(const PathSource& source, const FrameContext& frame, bool wanted, const Outputs&... outputs) {
  if (!wanted) return trace_paths(source, frame, outputs...);
  return trace_paths(source, frame, outputs..., SpecularOutput{frame.write(kRadianceSpecular)});
}

template <typename... Outputs>
bool trace_with(const PathSource& source, const FrameContext& frame, const PathRecords& records,
                const Outputs&... outputs) {
  if (!records.first_vertices) return trace_with_specular(source, frame, records.specular, outputs...);
  return trace_with_specular(source, frame, records.specular, outputs...,
                             FirstVertexOutput{frame.write(kFirstVertices)});
}

}  // namespace

bool PathPass::run(const FrameContext& frame) {
  const RadianceOutput radiance{frame.write(kRadiance)};
  if (!recording_) return trace_with(source_, frame, records_, radiance);
  return trace_with(source_, frame, records_, radiance, RecordingOutput{*recording_});
}

}  // namespace relume
