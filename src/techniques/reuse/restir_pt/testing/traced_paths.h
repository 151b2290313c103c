// The first paths of a small image, for tests of their shifts.
#pragma once

#include <string_view>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/reuse/restir_pt/path_candidates.h"
#include "techniques/reuse/restir_pt/path_shift.h"

namespace relume::testing {

class TracedPaths {
 public:
  static constexpr uint32_t kEdge = 24;  ///< pixels
  static constexpr uint32_t kPixels = kEdge * kEdge;

  template <typename Suffix = PlainSuffix>
  TracedPaths(const Scene& source, const ConnectRule& rule, uint32_t max_bounces, uint32_t sample = 3,
              bool has_cones = false, const Suffix& suffix = {})
      : TracedPaths(source) {
    set_shifter(rule, max_bounces, sample, has_cones);
    trace(shifter.context, FixedChoices{}, suffix);
  }
  /// With choices that learn, which must outlive the constructor only. If lights learn, all lights have equal
  /// probabilities, and fixed selection is by a light tree.
  template <typename Suffix = PlainSuffix>
  TracedPaths(const Scene& source, const ConnectRule& rule, uint32_t max_bounces, uint32_t sample,
              const DirectionSampler& directions, const LearnedChoices& learning, const Suffix& suffix = {},
              bool russian_roulette = true)
      : TracedPaths(source) {
    set_shifter(rule, max_bounces, sample, false);
    shifter.context.russian_roulette = russian_roulette;
    PathContext context = shifter.context;
    context.directions = directions;
    if (learning.learns_lights) {
      tree_ = build_light_tree(context.scene.lights);
      context.selector.tree = tree_.view(context.scene.lights);
      shifter.context.selector = context.selector;
      shifter.context.selector.kind = LightSelectorKind::light_tree;
    }
    trace(context, learning, suffix);
  }
  TracedPaths(const TracedPaths&) = delete;  // views refer to the object
  TracedPaths& operator=(const TracedPaths&) = delete;

  /// The path of pixel `from` at pixel `to`.
  Shifted shifted(uint32_t from, uint32_t to) const { return shifted(reservoirs[from].sample, to); }
  Shifted shifted(const StoredPath& path, uint32_t to) const {
    const SceneView& view = shifter.context.scene;
    uint32_t rays = 0;
    const ReceiverRecord& record = records[to];
    return shifter.shift(path, view.camera, view.instances[record.hit.instance], record, true, rays);
  }
  bool has_path(uint32_t pixel) const { return reservoirs[pixel].weight > 0.0f; }
  /// Luminance of a pixel's path in the image.
  float light(uint32_t pixel) const { return reservoirs[pixel].target * reservoirs[pixel].weight; }

 private:
  explicit TracedPaths(const Scene& source)
      : scene_(source, {.camera = {}, .width = kEdge, .height = kEdge}),
        reservoirs(kPixels),
        records(kPixels),
        radiance(kPixels),
        rays_(kPixels),
        hits_(kPixels) {}

  void set_shifter(const ConnectRule& rule, uint32_t max_bounces, uint32_t sample, bool has_cones) {
    const SceneView view = scene_.view();
    shifter.context.scene = view;
    shifter.context.selector.kind = LightSelectorKind::uniform;
    shifter.context.selector.uniform = make_uniform_lights(view.lights);
    shifter.context.max_bounces = max_bounces;
    shifter.rule = rule;
    shifter.index = {.seed = 7, .sample = sample};
    shifter.width = kEdge;
    shifter.has_cones = has_cones;
  }

  template <typename Choices, typename Suffix>
  void trace(const PathContext& context, const Choices& choices, const Suffix& suffix) {
    shifter.uses_cells = Suffix::uses_cells;
    PathCandidateKernel<Choices, Suffix> kernel;
    kernel.context = context;
    kernel.rule = shifter.rule;
    kernel.index = shifter.index;
    kernel.hits = view_of(hits_);
    kernel.reservoirs = mutable_view_of(reservoirs);
    kernel.records = mutable_view_of(records);
    kernel.image = {mutable_view_of(radiance), {}, mutable_view_of(rays_)};
    kernel.width = kEdge;
    kernel.has_cones = shifter.has_cones;
    kernel.choices = choices;
    kernel.suffix = suffix;
    const PrimaryHitsKernel primary{context.scene, shifter.index, mutable_view_of(hits_), {}, kEdge};
    for (uint32_t y = 0; y < kEdge; ++y) {
      for (uint32_t x = 0; x < kEdge; ++x) {
        primary(x, y);
        kernel(x, y);
      }
    }
  }

  CompiledScene scene_;
  LightTreeData tree_;

 public:
  PathShifter shifter;
  std::vector<PathReservoir> reservoirs;
  std::vector<ReceiverRecord> records;
  std::vector<Rgb> radiance;  ///< light of paths that are not finite

 private:
  std::vector<uint32_t> rays_;
  std::vector<Hit> hits_;
};

/// The rule of a kind of shift with the default settings.
inline ConnectRule rule_of(PathShiftKind shift, ConnectRuleKind kind = ConnectRuleKind::footprint) {
  const RestirPtSettings settings;
  return {shift, kind, sqr(settings.roughness), settings.distance, settings.footprint};
}

}  // namespace relume::testing
