#include "experiments/survey/technique_list.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "experiments/setup/apply_settings.h"
#include "relume/error.h"
#include "settings/setting.h"

namespace relume {
namespace {

TEST(TechniqueList, HasEveryChoiceOfEverySlot) {
  std::set<std::pair<std::string, std::string>> missing;
  RenderSettings defaults;
  for (const Setting& slot : describe_slots(defaults)) {
    for (const std::string_view name : std::get<ChoiceRef>(slot.value).names) missing.emplace(slot.name, name);
  }
  std::set<std::string> names;
  for (const SurveyTechnique& technique : survey_techniques()) {
    EXPECT_TRUE(names.insert(technique.name).second) << technique.name;
    EXPECT_EQ(technique.name.find(','), std::string::npos) << technique.name;  // commas separate names
    RenderSettings settings;
    apply_settings(technique.settings, technique.name, settings);
    for (const auto& slot : slots_of(settings)) missing.erase(slot);
  }
  EXPECT_TRUE(missing.empty()) << missing.begin()->first << ' ' << missing.begin()->second;
}

TEST(TechniqueList, CanBeFilteredByNameAndSlot) {
  EXPECT_EQ(chosen_techniques("").size(), survey_techniques().size());
  const std::vector<SurveyTechnique> list = chosen_techniques("vlc + svgf, allocation");
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].name, "path");
  EXPECT_EQ(list[1].name, "allocation=adaptive");
  EXPECT_EQ(list[2].name, "vlc + svgf");
  EXPECT_THROW(chosen_techniques("vlc + svfg"), Error);
}

TEST(TechniqueList, KnowsWhatKeepsState) {
  const auto keeps = [](const char* texts) {
    RenderSettings settings;
    apply_settings(texts, "test", settings);
    return keeps_state(settings);
  };
  for (const char* texts : {"", "estimator:bdpt", "lights:light-tree", "reuse:ris", "history:none"})
    EXPECT_FALSE(keeps(texts)) << texts;
  for (const char* texts : {"lights:vlc", "guide:cdq", "reuse:restir-gi", "cache:sharc", "denoise:svgf",
                            "history:reproject", "allocation:adaptive"})
    EXPECT_TRUE(keeps(texts)) << texts;
}

}  // namespace
}  // namespace relume
