#include "experiments/survey/survey_scenes.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/atomic_file.h"
#include "relume/error.h"

namespace relume {
namespace {

TEST(SurveyScenes, AreTheBuiltInOnesAndThoseOfTheFolder) {
  ExperimentContext context;
  EXPECT_EQ(survey_scene_names(context).size(), builtin_scenes().size());
  context.scene_folder = std::filesystem::temp_directory_path() / "relume_survey_scenes_test";
  for (const char* name : {"sponza", "attic"}) {
    std::filesystem::create_directories(context.scene_folder / name);
    write_file(context.scene_folder / name / (std::string(name) + ".gltf"), "{}");
  }
  std::filesystem::create_directories(context.scene_folder / "empty");
  const std::vector<std::string> names = survey_scene_names(context);
  ASSERT_EQ(names.size(), builtin_scenes().size() + 2);
  EXPECT_EQ(names[names.size() - 2], "Sponza");
  EXPECT_EQ(names.back(), "attic.gltf");
  EXPECT_EQ(chosen_scenes(context, "mine, attic.gltf,mine, skylight"),
            (std::vector<std::string>{"mine", "attic.gltf", "skylight"}));
  EXPECT_THROW(chosen_scenes(context, "mein"), Error);
  std::filesystem::remove_all(context.scene_folder);
  EXPECT_THROW(survey_scene_names(context), Error);
}

TEST(SurveyScenes, ChangeByAnimationOrByTheCamera) {
  const ExperimentContext context;
  const SurveyScene still = survey_scene(context, "corridor");  // only its camera moves
  EXPECT_EQ(still.time_after_s, 0);
  EXPECT_NE(still.camera_after.to_world, still.before.camera->to_world);
  const SurveyScene moving = survey_scene(context, "turntable");
  EXPECT_GT(moving.time_after_s, 0);
  EXPECT_EQ(moving.camera_after.to_world, moving.before.camera->to_world);
}

TEST(SurveyScenes, HaveReferencesThatFindTheirLight) {
  const ExperimentContext context;
  EXPECT_EQ(survey_scene(context, "door").reference, "lights:light-tree");
  EXPECT_NE(survey_scene(context, "cornell-water").reference.find("vcm"), std::string::npos);
}

}  // namespace
}  // namespace relume
