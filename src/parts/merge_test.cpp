#include "relume/merge.h"

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "parts/testing/rendered_parts.h"
#include "relume/error.h"

namespace relume {
namespace {

using testing::expect_same_channels;
using testing::PartRenderer;
using Files = std::vector<std::filesystem::path>;

const std::vector<std::string> kLayers{"albedo",  "normal",  "depth",     "motion",  "variance",
                                       "heatmap", "samples", "nonfinite", "radiance"};

RenderSettings small_settings() {
  RenderSettings settings;
  settings.width = 24;
  settings.height = 18;
  settings.threads = 2;
  return settings;
}

PartRenderer cornell(const RenderSettings& settings = small_settings(), std::vector<std::string> layers = kLayers) {
  return {[] { return find_builtin_scene("cornell")->build(); }, settings, std::move(layers)};
}

/// Writes parts of 16 samples each, from the first one on.
Files write_parts(const PartRenderer& renderer, const TempFolder& folder, uint32_t count) {
  Files files;
  for (uint32_t i = 0; i < count; ++i) {
    files.push_back(folder / ("part" + std::to_string(i) + ".exr"));
    renderer.write(files.back(), {16 * i, 16 * i + 15});
  }
  return files;
}

std::string message_of(const Files& parts, const std::filesystem::path& output) {
  try {
    merge_images(parts, output);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Merge, OfEightPartsInAnyOrderHasTheBitsOfOneRun) {
  const TempFolder folder;
  const PartRenderer renderer = cornell();
  Files parts = write_parts(renderer, folder, 8);
  const ExrFile whole = renderer.whole(128);
  for (const std::vector<size_t>& order :
       {std::vector<size_t>{0, 1, 2, 3, 4, 5, 6, 7}, {7, 6, 5, 4, 3, 2, 1, 0}, {3, 0, 7, 5, 1, 6, 2, 4}}) {
    Files ordered;
    for (const size_t i : order) ordered.push_back(parts[i]);
    const MergeReport report = merge_images(ordered, folder / "out.exr");
    EXPECT_EQ(report.samples, 128u);
    EXPECT_EQ(report.missing, 0u);
    EXPECT_EQ(report.ranges, "0-127");
    const ExrFile merged = read_exr(folder / "out.exr");
    expect_same_channels(merged, whole);
    EXPECT_EQ(merged.attributes.at("relume.samples_per_pixel"), "128");
    EXPECT_EQ(merged.attributes.at("relume.timings"), R"({"render_s": 12.000000})");
    EXPECT_FALSE(merged.attributes.contains(kSumsAttribute));
  }
}

TEST(Merge, OfAnIncompleteLastBlockHasTheBitsOfOneRun) {
  const TempFolder folder;
  const PartRenderer renderer = cornell();
  renderer.write(folder / "a.exr", {0, 31});
  renderer.write(folder / "b.exr", {32, 36});
  merge_images({folder / "b.exr", folder / "a.exr"}, folder / "out.exr");
  expect_same_channels(read_exr(folder / "out.exr"), renderer.whole(37));
}

TEST(Merge, OfMergesHasTheBitsOfOneRun) {
  const TempFolder folder;
  const PartRenderer renderer = cornell();
  const Files parts = write_parts(renderer, folder, 4);
  const MergeReport odd = merge_images({parts[3], parts[1]}, folder / "odd.exr", true);
  EXPECT_EQ(odd.missing, 32u);
  EXPECT_EQ(odd.ranges, "16-31,48-63");
  merge_images({parts[0], parts[2]}, folder / "even.exr", true);
  merge_images({folder / "odd.exr", folder / "even.exr"}, folder / "out.exr");
  expect_same_channels(read_exr(folder / "out.exr"), renderer.whole(64));
}

TEST(Merge, KeepsTheWindow) {
  const TempFolder folder;
  RenderSettings settings = small_settings();
  settings.crop = {5, 4, 12, 9};
  const PartRenderer renderer = cornell(settings);
  merge_images(write_parts(renderer, folder, 2), folder / "out.exr");
  const ExrFile merged = read_exr(folder / "out.exr");
  EXPECT_EQ(merged.data_window, settings.crop);
  expect_same_channels(merged, renderer.whole(32));
}

TEST(Merge, WorksWithoutLayers) {
  const TempFolder folder;
  const PartRenderer renderer = cornell(small_settings(), {});
  merge_images(write_parts(renderer, folder, 2), folder / "out.exr");
  expect_same_channels(read_exr(folder / "out.exr"), renderer.whole(32));
}

TEST(Merge, OfAdaptingTechniquesIsTheMeanOfIndependentRenders) {
  const TempFolder folder;
  RenderSettings settings = small_settings();
  settings.lights = LightSelectionChoice::vlc;
  const PartRenderer renderer = cornell(settings, {"variance"});
  Files parts{folder / "a.exr", folder / "b.exr"};
  renderer.write(parts[0], {0, 15});
  renderer.write(parts[1], {16, 63});
  const MergeReport report = merge_images(parts, folder / "out.exr");
  EXPECT_EQ(report.replicas, 2u);
  const ExrFile merged = read_exr(folder / "out.exr");
  EXPECT_EQ(merged.attributes.at(kReplicasAttribute), "2");
  const ExrFile a = read_exr(parts[0]);
  const ExrFile b = read_exr(parts[1]);
  double difference = 0;
  for (size_t i = 0; i < merged.find("G")->values.size(); ++i) {
    const float mean = 0.25f * a.find("G")->values[i] + 0.75f * b.find("G")->values[i];
    EXPECT_NEAR(merged.find("G")->values[i], mean, 1e-5f * mean + 1e-7f);
    difference += std::fabs(static_cast<double>(a.find("G")->values[i] - b.find("G")->values[i]));
  }
  EXPECT_GT(difference, 0) << "the parts have the same random numbers";
  expect_same_channels(a, [&] {
    ExrFile first = renderer.whole(16);
    for (const ExrChannel& channel : a.channels) {
      if (channel.name.starts_with(kSumsPrefix)) first.channels.push_back(channel);
    }
    return first;
  }());
}

TEST(Merge, VarianceFallsWithTheNumberOfSamples) {
  const TempFolder folder;
  const PartRenderer renderer = cornell(small_settings(), {"variance"});
  const Files parts = write_parts(renderer, folder, 8);
  merge_images(parts, folder / "out.exr");
  const auto sum_of_variances = [](const std::filesystem::path& path) {
    const ExrFile file = read_exr(path);
    double sum = 0;
    for (const float variance : file.find("variance.Y")->values) sum += static_cast<double>(variance);
    return sum;
  };
  double of_parts = 0;
  for (const std::filesystem::path& part : parts) of_parts += sum_of_variances(part);
  // The variance of the mean of eight parts is an eighth of that of a part.
  EXPECT_NEAR(sum_of_variances(folder / "out.exr") * 64 / of_parts, 1, 0.15);
}

TEST(Merge, RefusesWhatDoesNotBelongTogether) {
  const TempFolder folder;
  const std::filesystem::path out = folder / "out.exr";
  const std::filesystem::path a = folder / "a.exr";
  const std::filesystem::path b = folder / "b.exr";
  cornell().write(a, {0, 15});
  const auto refusal = [&](const PartRenderer& other) {
    other.write(b, {16, 31});
    return message_of({a, b}, out);
  };
  RenderSettings settings = small_settings();
  settings.seed = 7;
  EXPECT_NE(refusal(cornell(settings)).find("a.exr has seed '0', but"), std::string::npos);
  settings = small_settings();
  settings.width = 25;
  EXPECT_NE(refusal(cornell(settings)).find("has width '24', but"), std::string::npos);
  settings = small_settings();
  settings.crop = {0, 0, 4, 4};
  EXPECT_NE(refusal(cornell(settings)).find("different windows"), std::string::npos);
  EXPECT_NE(refusal(cornell(small_settings(), {"albedo"})).find("different layers"), std::string::npos);
  EXPECT_NE(refusal(cornell(small_settings(), {})).find("different layers"), std::string::npos);
  const PartRenderer furnace([] { return find_builtin_scene("furnace")->build(); }, small_settings(), kLayers);
  EXPECT_NE(refusal(furnace).find("different scenes"), std::string::npos);
  EXPECT_NE(message_of({a, a}, out).find("share samples (0-15 and 0-15)"), std::string::npos);
  cornell().write(b, {0, 31});
  EXPECT_NE(message_of({b, a}, out).find("share samples (0-31 and 0-15)"), std::string::npos);
  EXPECT_NE(message_of({a, folder / "lost.exr"}, out).find("does not exist"), std::string::npos);
  EXPECT_NE(message_of({a}, folder / "out.png").find("written as .exr"), std::string::npos);
  EXPECT_NE(message_of({}, out).find("no part"), std::string::npos);
  settings = small_settings();
  settings.threads = 1;
  EXPECT_EQ(refusal(cornell(settings)), "no error") << "the number of threads changes no bits";
}

TEST(Merge, RefusesFilesWithoutSums) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "image.exr";
  const PartRenderer renderer = cornell(small_settings(), {});
  ExrFile exr = renderer.whole(1);
  write_exr(file, exr);
  EXPECT_NE(message_of({file}, folder / "out.exr").find("has no sums of samples"), std::string::npos);
  AllSettings denoised;
  denoised.render.denoise = DenoiseChoice::svgf;
  exr.attributes["relume.settings"] = settings_to_json(describe(denoised));
  write_exr(file, exr);
  EXPECT_NE(message_of({file}, folder / "out.exr").find("a denoised image is no mean"), std::string::npos);
  exr.attributes.clear();
  write_exr(file, exr);
  EXPECT_NE(message_of({file}, folder / "out.exr").find("no image that relume rendered"), std::string::npos);
  exr = renderer.whole(1);
  exr.attributes[kSumsAttribute] = part_attributes({}, false).at(kSumsAttribute);
  exr.attributes[kSamplesAttribute] = "0-0";
  write_exr(file, exr);
  EXPECT_NE(message_of({file}, folder / "out.exr").find("channels of its sums are missing"), std::string::npos);
  exr.attributes[kSamplesAttribute] = "6-15";
  write_exr(file, exr);
  EXPECT_NE(message_of({file}, folder / "out.exr").find("relume.samples is damaged"), std::string::npos);
}

/// Sums of samples in other blocks would have other bits than a single run.
TEST(Merge, RefusesSumsWithOtherBlocks) {
  const TempFolder folder;
  const Files parts = write_parts(cornell(small_settings(), {}), folder, 2);
  ExrFile exr = read_exr(parts[1]);
  ASSERT_EQ(exr.attributes.at(kSumsAttribute), "radiance in blocks of 4");
  for (const char* other : {"radiance in blocks of 16", "radiance", "radiance,surface"}) {
    exr.attributes[kSumsAttribute] = other;
    write_exr(parts[1], exr);
    EXPECT_NE(message_of(parts, folder / "out.exr").find("sums of another version"), std::string::npos) << other;
  }
  exr.attributes[kSumsAttribute] = "light";
  write_exr(parts[1], exr);
  EXPECT_NE(message_of(parts, folder / "out.exr").find("relume.sums is damaged"), std::string::npos);
}

TEST(Merge, RefusesFilesThatAreCutOffAndKeepsTheOutput) {
  const TempFolder folder;
  const PartRenderer renderer = cornell(small_settings(), {});
  const Files parts = write_parts(renderer, folder, 2);
  const std::filesystem::path out = folder / "out.exr";
  merge_images(parts, out);
  const auto size = std::filesystem::file_size(parts[1]);
  for (const double kept : {0.0, 0.01, 0.2, 0.6, 0.9, 0.999}) {
    renderer.write(parts[1], {16, 31});
    std::filesystem::resize_file(parts[1], static_cast<uintmax_t>(kept * static_cast<double>(size)));
    EXPECT_NE(message_of(parts, out), "no error") << kept;
    EXPECT_EQ(folder.file_count(), 3u) << "a temporary file remains";
    expect_same_channels(read_exr(out), renderer.whole(32));
  }
}

}  // namespace
}  // namespace relume
