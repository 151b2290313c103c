// Computes quotients of noisy values with 95 % intervals, and claims based on them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/experiment.h"

namespace relume {

/// A quotient. Confidence 0 marks a single value, which then is the whole interval.
struct Ratio {
  double value = 0;
  Interval interval;
};

/// Mean of a over mean of b for independent values: the factor by which b's error is lower. Delta method in logarithms,
/// and Student's t with Welch's degrees of freedom. Means may be negative after subtraction of the reference's noise:
/// if a's is not positive, the value is 0 and the interval ends at a's upper over b's lower bound; if b's is not, the
/// interval is unbounded.
Ratio error_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// Same for paired values, such as repetitions with the same random numbers: their common deviations do not widen the
/// interval.
Ratio paired_error_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// Factor by which b is faster: median of the quotients of each turn's frame times in seconds, with the same number of
/// a and b. Slowdowns and costs that affect a whole turn cancel.
Ratio time_ratio(const std::vector<double>& a_s, const std::vector<double>& b_s);

/// Geometric mean of independent quotients, one per repetition.
Ratio geometric_mean(const std::vector<double>& quotients);

/// Product and quotient of independent ratios.
Ratio product(const Ratio& a, const Ratio& b);
Ratio quotient(const Ratio& a, const Ratio& b);

/// "10.3× (9.8 to 10.9)"; "0× (at least 0)" without an upper bound.
std::string to_text(const Ratio& ratio);
/// "0.52 (0.50 to 0.54)", for shares; "0.52" for a single value.
std::string share_text(const Ratio& ratio);

/// Claim that every ratio is at least `least`, by the intervals; `threshold` is derived from it.
Claim judged_ratios(std::string id, std::string paper, std::string claim, std::string measured,
                    const std::vector<Ratio>& ratios, double least);

/// Claim that every ratio is in [least, most], by the intervals.
Claim judged_within(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                    const std::vector<Ratio>& ratios, double least,
                    double most = std::numeric_limits<double>::infinity());

}  // namespace relume
