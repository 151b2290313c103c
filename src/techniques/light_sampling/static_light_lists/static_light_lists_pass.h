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
  StaticLightListsPass(const StaticLightListsSettings& settings, const LightSelectionSettings& selection)
      : settings_(settings), selection_(selection) {
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
  StaticLightListsSettings settings_;
  LightSelectionSettings selection_;
  LightSelector selector_;
  std::optional<LightListBuilder> builder_;  ///< present until the lists are complete
  LightListData lists_;
  LightListOptions options_;
  uint32_t listed_ = 0;  ///< number of finite lights when the lists were built
  std::vector<AliasEntry> all_;
  std::vector<AliasEntry> infinite_;
  std::vector<CompactLight> compact_;
  bool built_ = false;
  bool restored_ = false;  ///< whether lists_ comes from a checkpoint
};

}  // namespace relume
