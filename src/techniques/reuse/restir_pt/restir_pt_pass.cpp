#include "techniques/reuse/restir_pt/restir_pt_pass.h"

#include <algorithm>

#include "techniques/radiance_cache/path_graphs/path_graphs_pass.h"
#include "techniques/radiance_cache/sharc/sharc_pass.h"
#include "techniques/reuse/reservoir/reuse_pass.h"
#include "techniques/reuse/restir_pt/cached_restir_pt_pass.h"
#include "techniques/reuse/restir_pt/path_candidates.h"
#include "techniques/reuse/restir_pt/path_duplicates.h"
#include "techniques/reuse/restir_pt/path_pairs.h"
#include "techniques/reuse/restir_pt/path_spatial.h"
#include "techniques/reuse/restir_pt/path_temporal.h"

namespace relume {
namespace {

constexpr ReuseBuffers<StoredPath> kPaths{
    {"restir-pt-reservoirs"}, {"restir-pt-history"}, {"restir-pt-receivers"}, "paths"};
constexpr BufferKey<uint32_t> kPathDuplicates{"restir-pt-duplicates"};
/// By number of the pair.
constexpr BufferKey<PairedPath> kPairedPaths[kMostReuseNeighbours] = {
    {"restir-pt-pair-1"}, {"restir-pt-pair-2"}, {"restir-pt-pair-3"}, {"restir-pt-pair-4"},
    {"restir-pt-pair-5"}, {"restir-pt-pair-6"}, {"restir-pt-pair-7"}, {"restir-pt-pair-8"}};

/// Changes after which reservoirs of the previous frame are not reused. The light of their paths depends on all lights
/// and surfaces.
Change ends_reservoirs(const RestirPtSettings& settings) {
  const bool exact = settings.correction == PathCorrection::exact;
  return exact ? kEndsReservoirs | Change::geometry | Change::lights : kEndsReservoirs;
}

ConnectRule rule_of(const RestirPtSettings& settings) {
  return {.shift = settings.shift,
          .kind = settings.connect,
          .least_alpha = sqr(settings.roughness),
          .least_distance = settings.distance,
          .least_footprint = settings.footprint};
}

bool has_cones(const RestirPtSettings& settings) { return settings.textures == PathTextures::cones; }

}  // namespace

PassDeclaration RestirPtPass::declaration() const {
  PassDeclaration declaration{.name = "restir-pt",
                              .stage = Stage::resolve,
                              .owns = reuse_descriptions(kPaths, ends_reservoirs(settings_)),
                              .reads = {kPrimaryHits},
                              .writes = {kRadiance, kRays},
                              .reads_if_any = {kAllocation},
                              .writes_if_any = {kRadianceSpecular, kFirstVertices}};
  read_surfaces(declaration);
  if (finds_duplicates()) {
    declaration.owns.push_back(
        {.id = kPathDuplicates, .help = "number of pixels around each one that had the same path"});
  }
  for (size_t i = 0; settings_.reciprocal && i < static_cast<size_t>(settings_.neighbours); ++i)
    declaration.owns.push_back({.id = kPairedPaths[i], .help = "path of the other pixel of a pair at this pixel"});
  return declaration;
}

bool RestirPtPass::run(const FrameContext& frame) {
  return trace_candidates(frame) && count_duplicates(frame) && reuse_history(frame) && shift_pairs(frame) &&
         reuse_neighbours(frame);
}

PathShifter RestirPtPass::shifter(const FrameContext& frame) const {
  return {.context = make_path_context(source_, frame),
          .rule = rule_of(settings_),
          .index = frame.index,
          .width = frame.width(),
          .has_cones = has_cones(settings_),
          .uses_cells = uses_cells()};
}

PathContext RestirPtPass::learned_context(const FrameContext& frame) const {
  PathContext context = make_path_context(source_, frame);
  if (learning_.selector) {
    context.selector = *learning_.selector;
    context.selector.tree = source_.selector.tree;
  }
  if (learning_.directions) context.directions = *learning_.directions;
  return context;
}

LearnedChoices RestirPtPass::learned_choices() const {
  LearnedChoices choices;
  choices.learns_lights = learning_.selector != nullptr;
  choices.records_samples = learning_.samples != nullptr;
  if (learning_.samples) choices.samples = *learning_.samples;
  choices.chains = chain_output(learning_.chains);
  return choices;
}

template <typename Suffix>
bool RestirPtPass::trace_candidates_with(const FrameContext& frame, const Suffix& suffix) const {
  if (!learning_.any()) return trace_candidates_by(frame, make_path_context(source_, frame), FixedChoices{}, suffix);
  PathContext context = learned_context(frame);
  LearnedChoices choices = learned_choices();
  // Recorders of chains assume one probability of the BSDF at all vertices.
  for (MarkovGuide* const guide : {&context.directions.chains, &choices.chains.guide.guide})
    guide->bsdf_fraction = std::max(guide->bsdf_fraction, kLeastBsdfShare);
  return trace_candidates_by(frame, context, choices, suffix);
}

template <typename Choices, typename Suffix>
bool RestirPtPass::trace_candidates_by(const FrameContext& frame, const PathContext& context, const Choices& choices,
                                       const Suffix& suffix) const {
  PathCandidateKernel<Choices, Suffix> kernel;
  kernel.context = context;
  kernel.rule = rule_of(settings_);
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.reservoirs = frame.write(kPaths.reservoirs);
  kernel.records = frame.write(kPaths.receivers);
  kernel.first_vertices = frame.write(kFirstVertices);
  kernel.image = reuse_image(frame);
  kernel.width = frame.width();
  kernel.has_cones = has_cones(settings_);
  kernel.choices = choices;
  kernel.suffix = suffix;
  return frame.launch_or_stop("restir-pt-trace", kernel);
}

bool RestirPtPass::trace_candidates(const FrameContext& frame) const {
  return trace_candidates_with(frame, PlainSuffix{});
}

bool SharcRestirPtPass::trace_candidates(const FrameContext& frame) const {
  return trace_candidates_with(frame, SharcSuffix{make_cell_ends(sharc_, cells_.filter(), {})});
}

bool GraphRestirPtPass::trace_candidates(const FrameContext& frame) const {
  return trace_candidates_with(frame, GraphSuffix{make_path_graph(graphs_, cells_.filter())});
}

bool RestirPtPass::count_duplicates(const FrameContext& frame) const {
  if (!finds_duplicates()) return true;
  PathDuplicatesKernel kernel;
  kernel.history = frame.previous(kPaths.history);
  kernel.duplicates = frame.write(kPathDuplicates);
  kernel.width = frame.width();
  kernel.height = frame.height();
  return frame.launch_or_stop("restir-pt-duplicates", kernel);
}

bool RestirPtPass::reuse_history(const FrameContext& frame) const {
  if (settings_.cap == 0) return true;
  PathTemporalKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.history = reservoir_history(frame, kPaths, settings_.cap);
  kernel.records = frame.write(kPaths.receivers);
  kernel.reservoirs = frame.write(kPaths.reservoirs);
  kernel.rays = frame.write(kRays);
  kernel.sampled = sampled_pixels(frame);
  kernel.correction = settings_.correction;
  if (finds_duplicates()) kernel.duplicates = frame.read(kPathDuplicates);
  kernel.limit = DuplicateLimit::of(settings_.duplication);
  return frame.launch_or_stop("restir-pt-temporal", kernel);
}

PairSearch RestirPtPass::pairs(const FrameContext& frame) const {
  return {.search = neighbour_search(frame, settings_.neighbours, settings_.radius),
          .seed = frame.index.seed,
          .frame = frame.index.frame,
          .edge = pair_tile_edge(settings_.radius)};
}

bool RestirPtPass::shift_pairs(const FrameContext& frame) const {
  if (!settings_.reciprocal) return true;
  PathPairKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.pairs = pairs(frame);
  kernel.reservoirs = frame.read(kPaths.reservoirs);
  kernel.records = frame.read(kPaths.receivers);
  for (uint32_t i = 0; i < kernel.pairs.search.count; ++i) kernel.paths[i] = frame.write(kPairedPaths[i]);
  kernel.rays = frame.write(kRays);
  kernel.sampled = sampled_pixels(frame);
  return frame.launch_or_stop("restir-pt-pairs", kernel);
}

bool RestirPtPass::reuse_neighbours(const FrameContext& frame) const {
  PathSpatialKernel kernel;
  kernel.shifter = shifter(frame);
  kernel.pairs = pairs(frame);
  if (settings_.reciprocal) {
    for (uint32_t i = 0; i < kernel.pairs.search.count; ++i) kernel.paired[i] = frame.read(kPairedPaths[i]);
  }
  kernel.reciprocal = settings_.reciprocal;
  kernel.reservoirs = frame.read(kPaths.reservoirs);
  kernel.records = frame.read(kPaths.receivers);
  kernel.history = frame.write(kPaths.history);
  kernel.first_vertices = frame.write(kFirstVertices);
  kernel.image = reuse_image(frame);
  kernel.correction = settings_.correction;
  kernel.feeds_back = settings_.feedback == ReuseFeedback::spatial;
  return frame.launch_or_stop("restir-pt-spatial", kernel);
}

}  // namespace relume
