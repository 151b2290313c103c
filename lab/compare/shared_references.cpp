#include "compare/shared_references.h"

#include <string>
#include <utility>

#include "compare/shared_results.h"
#include "core/clock.h"

namespace relume {
namespace {

std::optional<Reference> find(const ReferenceView& view) {
  return view.renderer->find(view.time_s, view.previous_time_s, view.camera);
}

}  // namespace

std::optional<std::vector<Reference>> share_references(SharedWork& shared, const std::vector<ReferenceView>& views,
                                                       const std::stop_token& stop, const ReferenceProgress& progress) {
  const bool is_first = shared.is_first();
  std::vector<std::optional<Reference>> known(views.size());
  SharedTasks halves{.tasks = {}, .run = {}, .progress = progress};
  for (size_t i = 0; i < views.size() && is_first; ++i) {
    known[i] = find(views[i]);
    if (!known[i]) halves.tasks.insert(halves.tasks.end(), {2 * i, 2 * i + 1});
  }
  ReferenceRenderer* used = nullptr;
  halves.run = [&](size_t task, const std::stop_token& halves_stop, const SharedTasks::Progress& half_progress) {
    const ReferenceView& view = views[task / 2];
    if (used && used != view.renderer) used->close_session();  // two scenes could exhaust memory
    used = view.renderer;
    const std::optional<ReferenceHalf> half = view.renderer->render_half(
        static_cast<int>(task % 2), view.time_s, view.previous_time_s, view.camera, halves_stop, half_progress);
    return half ? std::optional(to_bytes(*half)) : std::nullopt;
  };
  const double start_s = now_s();
  const std::optional<std::vector<std::string>> results = shared.gather(halves, stop);
  if (!results) return std::nullopt;
  for (size_t k = 0; k + 1 < results->size(); k += 2) {
    const size_t i = halves.tasks[k] / 2;
    const ReferenceView& view = views[i];
    known[i] = view.renderer->combine(view.time_s, view.previous_time_s, view.camera,
                                      {reference_half_from((*results)[k]), reference_half_from((*results)[k + 1])});
    known[i]->render_s = 2 * (now_s() - start_s) / static_cast<double>(results->size());
  }
  std::vector<Reference> references;
  for (size_t i = 0; i < views.size() && is_first; ++i) references.push_back(std::move(*known[i]));
  const std::optional<std::string> bytes = shared.share(is_first ? to_bytes(references) : std::string());
  if (!bytes) return std::nullopt;
  if (is_first) return references;
  for (const ReferenceView& view : views)
    view.renderer->remove_checkpoints(view.time_s, view.previous_time_s, view.camera);
  return references_from(*bytes);
}

}  // namespace relume
