// The steps of a comparison on several ranks.
#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "compare/comparing.h"
#include "compare/shared_references.h"
#include "compare/shared_results.h"
#include "relume/error.h"
#include "relume/version.h"
#include "settings/settings_json.h"

namespace relume {

/// Throws Error unless this rank compares the same as the first. Returns false if that one has ended.
bool Comparing::begin_sharing() {
  const ComparisonOptions& o = options();
  std::string own =
      fmt::format("{} {} {:016x} {} {} {} {} {} {} {} {}", version(), o.program, result_.scene_hash, o.spp, o.budget_s,
                  o.repetitions, o.reference_spp, o.reference_file.string(), o.times_s.size(), o.timed, o.on_all_ranks);
  for (const ContenderResult& contender : result_.contenders) own += contender.name + contender.settings;
  own += settings_to_json(describe(result_.reference_settings));
  const std::optional<std::string> first = shared_->share(own);
  if (first && *first != own) {
    throw Error(
        "this rank has another version of relume, scene or settings than rank 0; give all ranks the same program and "
        "files");
  }
  return first.has_value();
}

bool Comparing::share_references() {
  if (!begin_sharing()) return false;
  if (!references_.empty()) return true;  // a file, which all ranks read
  ReferenceRenderer renderer = reference_renderer();
  const std::vector<float> times = reference_times();
  std::vector<ReferenceView> views;
  for (size_t i = 0; i < times.size(); ++i)
    views.push_back({.renderer = &renderer, .time_s = times[i], .previous_time_s = times[i > 0 ? i - 1 : 0]});
  std::optional<std::vector<Reference>> references =
      relume::share_references(*shared_, views, stop_, stage("reference"));
  if (!references) return false;
  references_ = std::move(*references);
  return true;
}

/// The first rank measures all contenders while the others wait. Returns false if that was stopped.
bool Comparing::share_plan(FramePlan& plan) {
  const ComparisonOptions& o = options();
  if (o.budget_s <= 0 || settings_.empty()) return true;
  EqualTime equal;
  if (shared_->is_first()) {
    const Sessions sessions = sessions_of(0, settings_.size(), stop_);
    if (sessions.size() < settings_.size()) return false;
    const auto planned = plan_equal_time(sessions, o.times_s, o.budget_s, stop_, stage("timing"));
    if (!planned) return false;
    equal = *planned;
  }
  const std::optional<std::string> shared = shared_->share(to_bytes(equal));
  if (!shared) return false;
  equal = equal_time_from(*shared);
  plan.frames = equal.frames;
  result_.budget_spread = equal.spread();
  return true;
}

bool Comparing::share_contenders() {
  const ComparisonOptions& o = options();
  FramePlan plan{.frames = {}, .samples = static_cast<double>(o.spp)};
  if (!share_plan(plan)) return false;
  // Times are only comparable if contenders alternate on one machine, so a timed task has all of them.
  const bool timed = o.budget_s > 0 || o.timed;
  const size_t group_size = timed ? settings_.size() : 1;
  const size_t groups = settings_.empty() ? 0 : settings_.size() / group_size;
  const auto repetitions = static_cast<size_t>(o.repetitions);
  SharedTasks runs{.tasks = std::vector<size_t>(groups * repetitions),
                   .ranks = timed ? TaskRanks::one_per_host : TaskRanks::all,
                   .run = {},
                   .progress = stage("contenders")};
  std::iota(runs.tasks.begin(), runs.tasks.end(), size_t{0});
  Sessions sessions;
  std::optional<size_t> group;  // of the sessions; tasks of a group are neighbours
  runs.run = [&](size_t task, const std::stop_token& stop,
                 const SharedTasks::Progress& progress) -> std::optional<std::string> {
    if (group != task / repetitions) {
      group.reset();
      sessions.clear();
      sessions = sessions_of(task / repetitions * group_size, group_size, stop);
      if (sessions.size() < group_size) return std::nullopt;
      group = task / repetitions;
    }
    for (const auto& session : sessions) session->session().shorten_preparation_on(stop);
    RunResult result{.threads = sessions.front()->session().statistics().threads, .repetitions = {}, .images = {}};
    const bool done = run_repetition(sessions, o, plan, references_, static_cast<int>(task % repetitions), stop,
                                     result.repetitions, result.images, progress);
    return done ? std::optional(to_bytes(result)) : std::nullopt;
  };
  const std::optional<std::vector<std::string>> results = shared_->gather(runs, stop_);
  if (!results) return false;
  if (!o.on_all_ranks) {
    if (shared_->is_first()) keep_results(*results);
    return true;
  }
  const std::optional<std::string> shared = shared_->share(shared_->is_first() ? to_bytes(*results) : std::string());
  if (!shared) return false;
  keep_results(shared_->is_first() ? *results : texts_from(*shared));
  return true;
}

/// `results`: of share_contenders(), group by group.
void Comparing::keep_results(const std::vector<std::string>& results) {
  const auto repetitions = static_cast<size_t>(options().repetitions);
  for (size_t task = 0; task < results.size(); ++task) {
    RunResult result = run_result_from(results[task]);
    result_.threads = std::max(result_.threads, result.threads);
    for (size_t i = 0; i < result.repetitions.size(); ++i)
      add_repetition(task / repetitions + i, std::move(result.repetitions[i]), std::move(result.images[i]));
  }
  split_errors();
}

}  // namespace relume
