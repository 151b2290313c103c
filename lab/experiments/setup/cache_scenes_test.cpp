#include "experiments/setup/cache_scenes.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "experiments/setup/named.h"
#include "settings/setting.h"

namespace relume {
namespace {

/// Names of the settings in which an option differs from its basis.
std::set<std::string> changed_by(const CacheOption& option) {
  ExperimentContext context;
  const ExperimentScene scene;
  const auto basis = cache_contenders(context, scene);
  const auto options = option_contenders(context, scene);
  RenderSettings before = named(basis, "contender", option.basis).settings;
  RenderSettings after = named(options, "contender", option.name).settings;
  const SettingList a = describe(before);
  const SettingList b = describe(after);
  std::set<std::string> names;
  for (const Setting* setting : differing_settings(a, b)) names.emplace(setting->name);
  names.erase("apg.feed");  // bases have the thesis' feed, which only path graphs use
  return names;
}

TEST(CacheOptions, EachChangesASetting) {
  for (const CacheOption& option : kCacheOptions) EXPECT_EQ(changed_by(option).size(), 1u) << option.name;
}

TEST(CacheOptions, CoverTheSettingsOfTheirPapers) {
  std::set<std::string> all;
  for (const CacheOption& option : kCacheOptions) all.merge(changed_by(option));
  for (const char* name : {"psf.undersampled-cells", "psf.split", "psf.refine", "psf.roughness-bins",
                           "apsf.survival-measure", "apg.guards"})
    EXPECT_EQ(all.count(name), 1u) << name;
}

}  // namespace
}  // namespace relume
