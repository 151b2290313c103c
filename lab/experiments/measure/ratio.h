// Quotients of noisy figures with 95 % intervals, and claims that are judged by them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/experiment.h"

namespace relume {

/// Confidence 0: there was one value, which then is the whole interval.
struct Ratio {
  double value = 0;
  Interval interval;
};

/// a's mean over b's, of independent values: how many times lower b's error is. Delta method in logarithms, Student's t
/// with Welch's degrees of freedom. Values may be negative, as what is left of errors without the reference's noise:
/// where a's mean is, the value is 0 and the interval ends where a's and b's bounds allow; where b's is, anything is
/// possible.
Ratio error_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// The same of values in pairs, as of repetitions in which both had the same random numbers: what both have from these
/// does not widen the interval.
Ratio paired_error_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// How many times faster b is: median of the quotients of each turn's frames, in seconds; as many of a as of b. What
/// slowed a whole turn down, or made its view cost more, does not count.
Ratio time_ratio(const std::vector<double>& a_s, const std::vector<double>& b_s);

/// Geometric mean of quotients that were measured independently, one a repetition.
Ratio geometric_mean(const std::vector<double>& quotients);

/// Of independent ratios.
Ratio product(const Ratio& a, const Ratio& b);
Ratio quotient(const Ratio& a, const Ratio& b);

/// "10.3× (9.8 to 10.9)"; "0× (at least 0)" where there is no upper bound.
std::string to_text(const Ratio& ratio);
/// "0.52 (0.50 to 0.54)", for shares; "0.52" of a single one.
std::string share_text(const Ratio& ratio);

/// A claim that every ratio is at least `least`, by their intervals; `threshold` is made of it.
Claim judged_ratios(std::string id, std::string paper, std::string claim, std::string measured,
                    const std::vector<Ratio>& ratios, double least);

/// A claim that every ratio lies from `least` to `most`, by their intervals.
Claim judged_within(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                    const std::vector<Ratio>& ratios, double least,
                    double most = std::numeric_limits<double>::infinity());

}  // namespace relume
