#include "experiments/setup/cache_scenes.h"

#include <optional>
#include <utility>

#include "experiments/setup/apply_settings.h"
#include "experiments/setup/references.h"

namespace relume {

std::vector<NamedSettings> cache_contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  const std::pair<const char*, CacheChoice> list[] = {{"path", CacheChoice::none},
                                                      {"psf", CacheChoice::psf},
                                                      {"apsf", CacheChoice::apsf},
                                                      {"apg", CacheChoice::apg},
                                                      {"apg+apsf", CacheChoice::apsf_apg}};
  std::vector<NamedSettings> contenders;
  for (const auto& [name, cache] : list) {
    NamedSettings contender{name, scene.settings};
    set_size_and_device(context, contender.settings);
    contender.settings.cache = cache;
    contender.settings.history = HistoryChoice::none;
    contender.settings.apg.feed = kThesisFeed;
    contenders.push_back(std::move(contender));
  }
  return contenders;
}

std::vector<NamedSettings> blend_contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  const std::pair<const char*, BlendFunction> list[] = {{"apsf, step", BlendFunction::step},
                                                        {"apsf, one-over-square", BlendFunction::one_over_square}};
  std::vector<NamedSettings> contenders;
  for (const auto& [name, blend] : list) {
    NamedSettings contender{name, scene.settings};
    set_size_and_device(context, contender.settings);
    contender.settings.cache = CacheChoice::apsf;
    contender.settings.history = HistoryChoice::none;
    contender.settings.apsf.survival = SurvivalFunction::one;
    contender.settings.apsf.blend = blend;
    contenders.push_back(std::move(contender));
  }
  return contenders;
}

std::vector<NamedSettings> option_contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<NamedSettings> contenders;
  for (const CacheOption& option : kCacheOptions) {
    NamedSettings contender{option.name, scene.settings};
    set_size_and_device(context, contender.settings);
    contender.settings.history = HistoryChoice::none;
    apply_settings(option.settings, option.name, contender.settings);
    contenders.push_back(std::move(contender));
  }
  return contenders;
}

bool measures_options(const ExperimentContext& context, const ExperimentScene& scene) {
  return !context.quick || scene.name == "cornell";
}

std::vector<ExperimentScene> cache_scenes(const ExperimentContext& context) {
  std::vector<ExperimentScene> scenes;
  scenes.push_back(built_in("cornell", 6));
  scenes.push_back(built_in("corridor", 10));
  if (std::optional<ExperimentScene> hall = sponza(context)) scenes.push_back(std::move(*hall));
  if (context.quick) return scenes;
  scenes.push_back(built_in("mine", 6));
  // Most of its cells are black in the first frames: sampling by power rarely chooses a lamp that lights them.
  scenes.push_back(at_rest(built_in("warehouse", 6)));
  return scenes;
}

}  // namespace relume
