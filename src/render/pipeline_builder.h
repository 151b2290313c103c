// Builds the list of a frame's passes, which follow the settings that they were made from.
#pragma once

#include <memory>
#include <utility>

#include "render/build_pipeline.h"

namespace relume {

/// Builds the list of a frame's passes.
class PipelineBuilder {
 public:
  PipelineBuilder(const RenderSettings& settings, FramePasses& passes, Memory& memory)
      : settings_(settings), passes_(passes), memory_(memory) {}

  /// Adds the pass and returns it, for passes that read its results. Its constructor takes the settings named by
  /// `members`, then `arguments`, then the memory if it owns data for kernels; its configure() follows these settings.
  template <typename P, auto... members, typename... Arguments>
  P& add(Arguments&&... arguments) {
    auto pass = make_pass<P>(memory_, settings_.*members..., std::forward<Arguments>(arguments)...);
    P& added = *pass;
    passes_.pipeline.add(std::move(pass));
    (follow<members>(added), ...);
    return added;
  }
  /// Adds a pass that traces paths and follows the path settings.
  template <typename P, auto... members, typename... Arguments>
  P& add_tracing(Arguments&&... arguments) {
    P& added = add<P, members...>(std::forward<Arguments>(arguments)...);
    follow<&RenderSettings::path>(added);
    return added;
  }
  /// Configures the pass with `values` of the settings, now and whenever settings change.
  template <typename P, typename Values>
  void add_follower(P& pass, const Values& values) {
    pass.configure(values(settings_));
    passes_.followers.push_back([&pass, values](const RenderSettings& now) { pass.configure(values(now)); });
  }
  const Pipeline& pipeline() const { return passes_.pipeline; }

 private:
  template <auto member, typename P>
  void follow(P& pass) {
    passes_.followers.push_back([&pass](const RenderSettings& now) { pass.configure(now.*member); });
  }

  const RenderSettings& settings_;
  FramePasses& passes_;
  Memory& memory_;
};

}  // namespace relume
