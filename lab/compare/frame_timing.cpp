#include "compare/frame_timing.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

namespace relume {
namespace {

FrameTiming timing_of(const std::string& name, const TimedSession& session, const TimedSession& first,
                      const std::vector<PassTime>& passes_before, int warm_up) {
  FrameTiming timing{.name = name};
  std::vector<double> ms;
  std::vector<double> ratios;
  for (size_t i = static_cast<size_t>(warm_up); i < session.frame_s().size(); ++i) {
    ms.push_back(1000 * session.frame_s()[i]);
    ratios.push_back(session.frame_s()[i] / first.frame_s()[i]);
  }
  for (const PassTime& pass : pass_times_since(session.passes(), passes_before))
    timing.pass_ms.emplace_back(pass.name, pass.seconds * (1000 / static_cast<double>(ms.size())));
  timing.ms_interval = median_interval(ms);
  timing.ms = median(std::move(ms));
  timing.ratio_interval = median_interval(ratios);
  timing.ratio = median(std::move(ratios));
  return timing;
}

}  // namespace

std::optional<std::vector<FrameTiming>> time_frames(const Scene& scene, const std::vector<TimedContender>& contenders,
                                                    int frames, const std::stop_token& stop,
                                                    const std::function<void(double)>& progress,
                                                    const FrameClock& clock) {
  std::vector<std::unique_ptr<TimedSession>> sessions;
  for (const TimedContender& contender : contenders) {
    if (stop.stop_requested()) return std::nullopt;
    sessions.push_back(std::make_unique<TimedSession>(scene, contender.settings, clock));
    sessions.back()->session().shorten_preparation_on(stop);
  }
  const int warm_up = (frames + 3) / 4;
  std::vector<std::vector<PassTime>> passes_before(sessions.size());
  for (int i = 0; i < warm_up + frames; ++i) {
    for (size_t k = 0; k < sessions.size(); ++k) {
      if (stop.stop_requested()) return std::nullopt;
      if (i == warm_up) passes_before[k] = sessions[k]->passes();
      sessions[k]->render_frame();
    }
    if (progress) progress((i + 1.0) / (warm_up + frames));
  }
  std::vector<FrameTiming> timings;
  for (size_t k = 0; k < sessions.size(); ++k)
    timings.push_back(timing_of(contenders[k].name, *sessions[k], *sessions.front(), passes_before[k], warm_up));
  return timings;
}

std::string to_csv(const std::vector<FrameTiming>& timings) {
  std::vector<std::string> passes;  // of all contenders
  for (const FrameTiming& t : timings) {
    for (const auto& [pass, ms] : t.pass_ms) {
      if (std::find(passes.begin(), passes.end(), pass) == passes.end()) passes.push_back(pass);
    }
  }
  std::string text = "name,ms,ms_low,ms_high,ratio,ratio_low,ratio_high";
  for (const std::string& pass : passes) text += fmt::format(",{} ms", pass);
  for (const FrameTiming& t : timings) {
    text += fmt::format("\n{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}", t.name, t.ms, t.ms_interval.low,
                        t.ms_interval.high, t.ratio, t.ratio_interval.low, t.ratio_interval.high);
    for (const std::string& pass : passes) {
      const auto found =
          std::find_if(t.pass_ms.begin(), t.pass_ms.end(), [&](const auto& entry) { return entry.first == pass; });
      text += found == t.pass_ms.end() ? "," : fmt::format(",{:.4g}", found->second);
    }
  }
  return text + "\n";
}

}  // namespace relume
