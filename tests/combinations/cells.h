// Table of all pairs of slot choices: supported combinations and their bias.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "render/render_settings.h"

namespace relume::support {

/// A choice of a slot.
struct Choice {
  std::string slot;
  std::string value;
  double bias = 0;  ///< largest relative change of the image's mean; 0: unbiased

  bool operator==(const Choice& o) const { return slot == o.slot && value == o.value; }
};

inline void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.slot << '=' << choice.value; }

/// Largest relative error of a cell's mean.
double bias_of(const Choice& a, const Choice& b);

/// Choices of all slots in the settings' order, with a separate entry for each reprojection method.
const std::vector<Choice>& all_choices();

/// Same for all choices in `settings`, and for other settings whose bias checks.json states: the sum of their bounds.
double bias_of(RenderSettings settings);

/// `settings` with two choices. Throws Error for a choice that does not exist.
RenderSettings combine(RenderSettings settings, const Choice& a, const Choice& b);

/// Settings of one or more cells of the table. Such cells differ only in choices that are defaults.
struct Cell {
  RenderSettings settings;
  std::vector<std::pair<Choice, Choice>> pairs;  ///< all pairs with these settings
  double bias = 0;                               ///< lowest stated bias of the pairs
};
std::string name_of(const std::pair<Choice, Choice>& pair);

/// Supported cells with distinct settings based on `base`.
std::vector<Cell> distinct_cells(const RenderSettings& base);

/// Relative difference of a cell's mean from path tracing's, and its relative standard error.
struct Deviation {
  double value = 0;
  double error = 0;
  double degrees = 0;  ///< of freedom of the error
};

/// docs/combinations.md without the last section. `holds` returns whether a cell rendered the expected mean.
std::string combination_table(const std::function<bool(const Choice& a, const Choice& b)>& holds);

/// Last section: the measured deviations of supported cells.
inline constexpr const char* kDeviationsTitle = "\n## Measured\n";
std::string deviation_table(const std::function<Deviation(const Choice& a, const Choice& b)>& measured);

}  // namespace relume::support
