#include "techniques/light_sampling/markov_chain_lights/markov_chain_lights_pass.h"

namespace relume {

bool MarkovChainLightsPass::run(const FrameContext& frame) {
  if (!built_ || includes(frame.changes, kRebuildsLights)) {
    built_ = true;
    frame.backend.run("mcls.tree", [&] {
      tree_.assign(build_light_tree(frame.scene.lights, selection_.infinity()));
      selector_.tree = tree_.view(frame.scene.lights);
    });
  }
  cells_.begin_frame(frame, settings_.grid);
  selector_.chains = {cells_.grid(), cells_.table(), settings_.base_fraction};
  recording_ = {.chains = selector_.chains,
                .tree = selector_.tree,
                .out = cells_.records(),
                .least_alpha = settings_.least_alpha,
                .most_count = static_cast<uint32_t>(settings_.most_count)};
  return true;
}

}  // namespace relume
