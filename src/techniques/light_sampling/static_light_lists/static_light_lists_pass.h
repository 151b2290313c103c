// The pass for the light selection "static-lists".
#pragma once

#include <optional>

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/static_light_lists/build_lists.h"
#include "techniques/light_sampling/static_light_lists/settings.h"

namespace relume {

/// Builds the lists in the first frame and keeps them when objects move. Later frames finish a build that `hurry`
/// ended.
class StaticLightListsPass final : public Pass {
 public:
  StaticLightListsPass(const StaticLightListsSettings& settings, const LightSelectionSettings& selection,
                       Memory& memory)
      : settings_(settings),
        selection_(selection),
        first_(memory),
        ids_(memory),
        all_(memory),
        infinite_(memory),
        compact_(memory),
        ltc_(memory) {
    selector_.kind = LightSelectorKind::static_lists;
  }

  void configure(const StaticLightListsSettings& settings) { settings_ = settings; }
  void configure(const LightSelectionSettings& selection) { selection_ = selection; }
  PassDeclaration declaration() const override { return {.name = "static-lists", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  bool prepared() const override { return !builder_; }
  size_t memory_bytes() const override;
  std::vector<PassRecords> records() const override;
  /// Saves the lists, if complete: a later build may see a changed scene.
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }

 private:
  /// Lists what the scene's visible sets show. Throws Error if the scene has none.
  void take_visible_sets(const FrameContext& frame);
  void build_lists(const FrameContext& frame);
  /// Copies the lists to the arrays that kernels read.
  void assign_lists(const LightListData& lists);
  /// Returns a host copy of the lists, or empty lists while they are incomplete.
  LightListData complete_lists() const;

  StaticLightListsSettings settings_;
  LightSelectionSettings selection_;
  LightSelector selector_;
  std::optional<LightListBuilder> builder_;  ///< present until the lists are complete
  LightGrid grid_;
  Array<uint32_t> first_;
  Array<LightId> ids_;
  LightListOptions options_;
  uint32_t listed_ = 0;  ///< number of finite lights when the lists were built
  Array<AliasEntry> all_;
  Array<AliasEntry> infinite_;
  Array<CompactLight> compact_;
  Array<LtcMatrix> ltc_;
  bool built_ = false;
  bool restored_ = false;  ///< whether the lists come from a checkpoint
};

}  // namespace relume
