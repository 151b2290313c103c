// Limits of a comparison, stated with its results.
#include <algorithm>

#include <fmt/format.h>

#include "compare/comparison.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

constexpr double kLargestShare = 0.1;   // of a figure, from the reference's noise
constexpr double kLargestRatio = 1.05;  // of nominally equal times

void note_times(const Comparison& c, std::vector<std::string>& notes) {
  std::vector<double> times;
  for (const ContenderResult& contender : c.contenders) {
    if (!contender.is_image) times.push_back(median_of(contender, &Repetition::time_s));
  }
  if (times.size() < 2) return;
  const auto [low, high] = std::minmax_element(times.begin(), times.end());
  if (*high <= kLargestRatio * *low) return;
  notes.push_back(fmt::format("The contenders' times differ by {:.0f} %{}.", 100 * (*high / *low - 1),
                              c.budget_spread > 0.03
                                  ? ", because the budget fits only a few whole frames; use a larger one"
                                  : "; other programs may have been busy"));
}

void note_nonfinite(const Comparison& c, std::vector<std::string>& notes) {
  if (c.reference_nonfinite > 0) {
    notes.push_back(fmt::format("The reference has pixels that are not finite ({}); all errors leave them out.",
                                c.reference_nonfinite));
  }
  for (const ContenderResult& contender : c.contenders) {
    const uint64_t most = most_nonfinite(contender);
    if (most == 0) continue;
    const bool of_several = contender.repetitions.size() > 1;
    notes.push_back(
        fmt::format("{} has pixels that are not finite ({}{}); its errors leave them out and may be too small, so it "
                    "is not ranked.",
                    contender.name, most, of_several ? " at most in a repetition" : ""));
  }
}

/// "35 % of the MSE", for each figure with a large share of reference noise.
std::vector<std::string> large_shares(const Comparison& c, const ContenderResult& contender) {
  // External images belong to the last frame.
  const ReferenceNoise noise =
      contender.is_image ? ReferenceNoise{c.reference.mse, c.reference.rel_mse, 0} : c.reference_noise;
  struct Part {
    const char* name;
    double noise;
    double measured;
  };
  const Part parts[] = {
      {"MSE", noise.mse, median_of(contender, &Repetition::mse)},
      {"relMSE", noise.rel_mse, median_of(contender, &Repetition::rel_mse)},
      {"temporal error", noise.temporal_error, median_of(contender, &Repetition::temporal_error)},
  };
  std::vector<std::string> shares;
  for (const Part& part : parts) {
    if (part.noise > 0 && part.measured > 0 && part.noise >= kLargestShare * part.measured)
      shares.push_back(fmt::format("{:.0f} % of the {}", 100 * part.noise / part.measured, part.name));
  }
  return shares;
}

}  // namespace

std::vector<std::string> limits_of(const Comparison& c) {
  std::vector<std::string> notes;
  if (c.options.budget_s > 0) note_times(c, notes);
  if (c.options.budget_s <= 0 && !c.options.timed && c.ranks > 1 && c.threads > 0) {
    notes.push_back(fmt::format(
        "The times were measured under parallel load, while {} ranks rendered; they do not rank the contenders.",
        c.ranks));
  }
  note_nonfinite(c, notes);
  if (c.reference.spp == 0) {
    notes.emplace_back("The reference is a file; every value includes its unknown error.");
    return notes;
  }
  for (const ContenderResult& contender : c.contenders) {
    const std::vector<std::string> shares = large_shares(c, contender);
    if (shares.empty()) continue;
    notes.push_back(fmt::format("The reference's own noise is {} of {}; raise --reference-spp to lower it.",
                                enumerate(shares), contender.name));
  }
  return notes;
}

}  // namespace relume
