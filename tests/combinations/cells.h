// Every choice of every slot against every choice of every other: what runs, and with what bias.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "render/render_settings.h"

namespace relume::support {

/// One choice of one slot.
struct Choice {
  std::string slot;
  std::string value;
  double bias = 0;  ///< by how much it may change the picture's mean, as a share; 0: not at all

  bool operator==(const Choice& o) const { return slot == o.slot && value == o.value; }
};

inline void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.slot << '=' << choice.value; }

/// The choices of all slots as the settings declare them, slot by slot, with the two ways to reproject apart.
const std::vector<Choice>& all_choices();

/// Defaults with two choices. Throws Error for a choice that does not exist.
RenderSettings combine(RenderSettings settings, const Choice& a, const Choice& b);

/// docs/combinations.md, where `holds` says whether a cell's rendering showed the right mean.
std::string combination_table(const std::function<bool(const Choice& a, const Choice& b)>& holds);

}  // namespace relume::support
