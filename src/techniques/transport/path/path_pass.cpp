#include "techniques/transport/path/path_pass.h"

#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/indirect_sample.h"
#include "techniques/transport/path/optional_output.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/specular_part.h"
#include "techniques/transport/path/trace_paths.h"

namespace relume {

std::vector<BufferDescription> estimator_buffers() {
  return {{.id = kRadiance, .help = "radiance of this frame's sample", .display = BufferDisplay::value},
          {.id = kRays, .help = "number of rays traced for this frame's sample", .display = BufferDisplay::value}};
}

BufferDescription first_vertices_buffer() {
  return {.id = kFirstVertices, .help = "directions from the first vertex of this frame's sample, and their light"};
}

BufferDescription first_scatters_buffer() {
  return {.id = kFirstScatters, .help = "direction sampled at the primary hit, and the light source that it meets"};
}

BufferDescription indirect_samples_buffer() {
  return {.id = kIndirectSamples, .help = "surface point met from the primary hit, and the light that it reflects"};
}

PathContext make_path_context(const PathSource& source, const FrameContext& frame) {
  PathContext context;
  context.scene = frame.scene;
  context.selector = source.selector;
  context.directions = source.directions;
  context.max_bounces = static_cast<uint32_t>(source.settings.max_bounces);
  context.russian_roulette = source.settings.russian_roulette;
  context.first_nee_bounce = source.first_nee_bounce;
  context.light_candidates = source.light_candidates;
  context.indirect_to_reservoirs = source.indirect_to_reservoirs;
  context.only_specular = source.only_specular;
  context.next_event = !source.directions.chains.replaces_lights;
  context.indirect = indirect_rate(source.settings.indirect_rate, frame.index, frame.blue_noise);
  return context;
}

ChainOutput chain_output(const ChainRecordings& chains) {
  ChainOutput output;
  if (chains.guide) output.guide = *chains.guide;
  if (chains.lights) output.lights = *chains.lights;
  return output;
}

PassDeclaration PathPass::declaration() const {
  PassDeclaration declaration{.name = "trace",
                              .stage = Stage::trace,
                              .owns = estimator_buffers(),
                              .reads = {kPrimaryHits},
                              .reads_if_any = {kAllocation},
                              .only_sampled_pixels = true};
  if (records_.first_vertices) declaration.owns.push_back(first_vertices_buffer());
  if (records_.first_scatters) declaration.owns.push_back(first_scatters_buffer());
  if (records_.indirect_samples) declaration.owns.push_back(indirect_samples_buffer());
  if (records_.specular) {
    declaration.owns.push_back({.id = kRadianceSpecular,
                                .help = "part of radiance scattered by specular lobes of the first surface",
                                .display = BufferDisplay::value});
  }
  return declaration;
}

namespace {

// Each combination of outputs has its own kernel, so unread outputs cost nothing. Exceptions: run_both(), and first
// vertices with indirect samples.

struct Tracing {
  const PathSource& source;
  const FrameContext& frame;
  const PathRecords& records;
  const FirstSurfaces* surfaces;

  template <typename... Outputs>
  bool run(const Outputs&... outputs) const {
    if (!records.first_scatters) return run_with_vertices(outputs...);
    return run_with_vertices(outputs..., FirstScatterOutput{frame.write(kFirstScatters)});
  }

  template <typename... Outputs>
  bool run_with_vertices(const Outputs&... outputs) const {
    if (!records.first_vertices) return run_with_specular(outputs...);
    return run_with_specular(outputs..., FirstVertexOutput{frame.write(kFirstVertices)});
  }

  template <typename... Outputs>
  bool run_indirect(const Outputs&... outputs) const {
    const IndirectSampleOutput samples{frame.write(kIndirectSamples)};
    if (records.first_vertices) {
      // After the samples: the record has the light that they leave to the path.
      return trace_paths(source, frame, surfaces, outputs..., optional_scatters(), samples,
                         FirstVertexOutput{frame.write(kFirstVertices)}, optional_specular());
    }
    if (!records.first_scatters) return run_with_specular(outputs..., samples);
    return run_with_specular(outputs..., FirstScatterOutput{frame.write(kFirstScatters)}, samples);
  }

  /// Records samples and states of chains on the same paths. Two kernels serve all combinations of the other outputs.
  bool run_both(const RadianceOutput& radiance, const PathRecording& recording, const ChainOutput& chains) const {
    const auto vertices = optional<FirstVertexOutput>(records.first_vertices, kFirstVertices);
    if (records.indirect_samples) {
      return trace_paths(source, frame, surfaces, radiance, CachedRecordingOutput{recording}, chains,
                         optional_scatters(), IndirectSampleOutput{frame.write(kIndirectSamples)}, vertices,
                         optional_specular());
    }
    return trace_paths(source, frame, surfaces, radiance, RecordingOutput{recording}, chains, optional_scatters(),
                       vertices, optional_specular());
  }

  OptionalOutput<FirstScatterOutput> optional_scatters() const {
    return optional<FirstScatterOutput>(records.first_scatters, kFirstScatters);
  }
  OptionalOutput<SpecularOutput> optional_specular() const {
    return optional<SpecularOutput>(records.specular, kRadianceSpecular);
  }

  template <typename Output, typename T>
  OptionalOutput<Output> optional(bool active, const BufferKey<T>& key) const {
    if (!active) return {};
    return {{frame.write(key)}, true};
  }

  template <typename... Outputs>
  bool run_with_specular(const Outputs&... outputs) const {
    if (!records.specular) return trace_paths(source, frame, surfaces, outputs...);
    return trace_paths(source, frame, surfaces, outputs..., SpecularOutput{frame.write(kRadianceSpecular)});
  }
};

}  // namespace

bool PathPass::run(const FrameContext& frame) {
  const Tracing tracing{source_, frame, records_, surfaces_};
  const RadianceOutput radiance{frame.write(kRadiance)};
  if (chains_.any()) {
    const ChainOutput chains = chain_output(chains_);
    if (recording_) return tracing.run_both(radiance, *recording_, chains);
    return records_.indirect_samples ? tracing.run_indirect(radiance, chains) : tracing.run(radiance, chains);
  }
  if (records_.indirect_samples) {
    return recording_ ? tracing.run_indirect(radiance, CachedRecordingOutput{*recording_})
                      : tracing.run_indirect(radiance);
  }
  return recording_ ? tracing.run(radiance, RecordingOutput{*recording_}) : tracing.run(radiance);
}

}  // namespace relume
