#include "techniques/guiding/markov_chain/markov_chain_pass.h"

namespace relume {

bool MarkovChainPass::run(const FrameContext& frame) {
  cells_.begin_frame(frame, settings_.grid);
  const MarkovGuide guide{.grid = cells_.grid(),
                          .table = cells_.table(),
                          .bsdf_fraction = settings_.bsdf_fraction,
                          .prior = settings_.prior,
                          .frame = frame.number,
                          .replaces_lights = !settings_.nee};
  directions_.chains = guide;
  recording_ = {.guide = guide,
                .out = cells_.records(),
                .rates = {settings_.least_alpha, static_cast<uint32_t>(settings_.most_count)},
                .recovers = settings_.recovery};
  return true;
}

}  // namespace relume
