// References whose halves several processes (ranks) render.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "compare/reference.h"
#include "compare/shared_work.h"

namespace relume {

/// A reference: its renderer, and the arguments of ReferenceRenderer::render().
struct ReferenceView {
  ReferenceRenderer* renderer;
  float time_s = 0;
  float previous_time_s = 0;
  std::optional<CameraPose> camera = {};
};

/// Returns the references on all ranks; std::nullopt if `stop` was requested first. The tasks are the halves of those
/// without a file on the first rank, which also writes the files.
std::optional<std::vector<Reference>> share_references(SharedWork& shared, const std::vector<ReferenceView>& views,
                                                       const std::stop_token& stop, const ReferenceProgress& progress);

}  // namespace relume
