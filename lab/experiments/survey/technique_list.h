// The techniques of the survey: every choice of every slot, and pairings that are used together.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/render_settings.h"

namespace relume {

struct SurveyTechnique {
  std::string name;
  std::string settings = {};  ///< in the syntax of `relume compare`; empty: path tracing with the defaults
};

/// Path tracing, each choice of each slot that is not the default as "SLOT=CHOICE", and the pairings. New choices of a
/// slot are part of it without a change.
std::vector<SurveyTechnique> survey_techniques();

/// The techniques that `names` lists, separated by commas: names, or slots for all of their choices.
/// "path", with which others are compared, is always part of it. Empty: all. Throws Error
/// for unknown names.
std::vector<SurveyTechnique> chosen_techniques(std::string_view names);

/// The choice of each slot.
std::vector<std::pair<std::string, std::string>> slots_of(const RenderSettings& settings);

/// Whether later frames depend on earlier ones after a change: histories, cells, reservoirs, what was learned.
bool keeps_state(const RenderSettings& settings);

}  // namespace relume
