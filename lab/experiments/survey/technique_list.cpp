#include "experiments/survey/technique_list.h"

#include <algorithm>

#include <fmt/format.h>

#include "relume/error.h"
#include "render/build_pipeline.h"
#include "settings/nearest_name.h"
#include "settings/setting.h"
#include "settings/text_list.h"

namespace relume {
namespace {

const SurveyTechnique kPath = {"path"};

const SurveyTechnique kPairings[] = {
    {"reproject + backward", "history:reproject,reproject.method:backward"},
    {"adaptive + reproject", "allocation:adaptive,history:reproject"},
    {"light-tree + svgf", "lights:light-tree,denoise:svgf"},
    {"vlc + svgf", "lights:vlc,denoise:svgf"},
    {"vlc + asvgf", "lights:vlc,denoise:asvgf"},
    {"vlc + cdq", "lights:vlc,guide:cdq"},
    {"vlc + cdq + svgf", "lights:vlc,guide:cdq,denoise:svgf"},
    {"apsf + light-tree + svgf", "cache:apsf,lights:light-tree,denoise:svgf"},
    {"sharc + light-tree + svgf", "cache:sharc,lights:light-tree,denoise:svgf"},
    {"ris + svgf", "reuse:ris,denoise:svgf"},
    {"restir-di + svgf", "reuse:restir-di,denoise:svgf"},
    {"restir-di + asvgf", "reuse:restir-di,denoise:asvgf"},
    {"restir-di + vlc + svgf", "reuse:restir-di,lights:vlc,denoise:svgf"},
    {"restir-gi + light-tree + svgf", "reuse:restir-gi,lights:light-tree,denoise:svgf"},
    {"restir-di+gi + light-tree + svgf", "reuse:restir-di+gi,lights:light-tree,denoise:svgf"},
    {"mcpg + light-tree + svgf", "guide:mcpg,lights:light-tree,denoise:svgf"},
    {"restir-pt + light-tree + svgf", "reuse:restir-pt,lights:light-tree,denoise:svgf"},
    {"bdpt + bmfr", "estimator:bdpt,denoise:bmfr"},
    {"bdpt + caustic-layer + svgf", "estimator:bdpt,denoise:svgf,bdpt.caustic-layer:true"},
};

/// Whether a filter selects the technique: its name, or its slot.
bool selects(std::string_view filter, const SurveyTechnique& technique) {
  return technique.name == filter || technique.name.starts_with(std::string(filter) + "=");
}

}  // namespace

std::vector<SurveyTechnique> survey_techniques() {
  std::vector<SurveyTechnique> list{kPath};
  RenderSettings defaults;
  for (const Setting& slot : describe_slots(defaults)) {
    const auto* choices = std::get_if<ChoiceRef>(&slot.value);
    if (!choices) continue;
    for (const std::string_view choice : choices->names) {
      if (choice == to_string(slot)) continue;
      list.push_back({fmt::format("{}={}", slot.name, choice), fmt::format("{}:{}", slot.name, choice)});
    }
  }
  list.insert(list.end(), std::begin(kPairings), std::end(kPairings));
  return list;
}

std::vector<SurveyTechnique> chosen_techniques(std::string_view names) {
  const std::vector<SurveyTechnique> all = survey_techniques();
  const std::vector<std::string_view> filters = split_at_commas(names);
  if (filters.empty()) return all;
  for (const std::string_view filter : filters) {
    if (std::any_of(all.begin(), all.end(), [&](const SurveyTechnique& t) { return selects(filter, t); })) continue;
    std::vector<std::string> known;
    for (const SurveyTechnique& technique : all) known.push_back(technique.name);
    throw Error(fmt::format("the survey has no technique '{}'{}", filter, suggestion(filter, known)));
  }
  std::vector<SurveyTechnique> list;
  for (const SurveyTechnique& technique : all) {
    const bool wanted = std::any_of(filters.begin(), filters.end(),
                                    [&](std::string_view filter) { return selects(filter, technique); });
    if (wanted || technique.name == kPath.name) list.push_back(technique);
  }
  return list;
}

std::vector<std::pair<std::string, std::string>> slots_of(const RenderSettings& settings) {
  RenderSettings copy = settings;
  std::vector<std::pair<std::string, std::string>> slots;
  for (const Setting& slot : describe_slots(copy)) slots.emplace_back(slot.name, to_string(slot));
  return slots;
}

bool keeps_state(const RenderSettings& settings) {
  const bool reuses = settings.reuse != ReuseChoice::none && settings.reuse != ReuseChoice::ris;
  const bool denoises = settings.denoise != DenoiseChoice::none && settings.denoise != DenoiseChoice::oidn;
  return learns(settings) || settings.lights == LightSelectionChoice::static_lists ||
         settings.cache != CacheChoice::none || reuses || denoises || settings.history == HistoryChoice::reproject ||
         settings.allocation == AllocationChoice::adaptive;
}

}  // namespace relume
