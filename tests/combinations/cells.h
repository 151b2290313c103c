// Every choice of every slot against every choice of every other: what runs, and with what bias.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "render/render_settings.h"

namespace relume::support {

/// One choice of one slot.
struct Choice {
  std::string slot;
  std::string value;
  double bias = 0;  ///< by how much it may change the image's mean, as a share; 0: not at all

  bool operator==(const Choice& o) const { return slot == o.slot && value == o.value; }
};

inline void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.slot << '=' << choice.value; }

/// How far a cell's mean may be off at most, as a share of it.
double bias_of(const Choice& a, const Choice& b);

/// The choices of all slots as the settings declare them, slot by slot, with the two ways to reproject apart.
const std::vector<Choice>& all_choices();

/// The same of all choices together that `settings` make.
double bias_of(RenderSettings settings);

/// Defaults with two choices. Throws Error for a choice that does not exist.
RenderSettings combine(RenderSettings settings, const Choice& a, const Choice& b);

/// Settings of one or more cells of the table, which differ in choices that are the defaults anyway.
struct Cell {
  RenderSettings settings;
  std::vector<std::pair<Choice, Choice>> pairs;  ///< all that make these settings
  double bias = 0;                               ///< the least that is stated for one of them
};
std::string name_of(const std::pair<Choice, Choice>& pair);

/// All that is to be compared: of cells that `base` lets run.
std::vector<Cell> distinct_cells(const RenderSettings& base);

/// How far the mean of a cell's images is from path tracing's, and the standard error of that, as shares of it.
struct Deviation {
  double value = 0;
  double error = 0;
};

/// docs/combinations.md but for the last section. `holds`: whether a cell's rendering showed the right mean.
std::string combination_table(const std::function<bool(const Choice& a, const Choice& b)>& holds);

/// The last section: what cells that are not refused were measured to be off by.
inline constexpr const char* kDeviationsTitle = "\n## Measured\n";
std::string deviation_table(const std::function<Deviation(const Choice& a, const Choice& b)>& measured);

}  // namespace relume::support
