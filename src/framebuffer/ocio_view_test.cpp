#include "framebuffer/ocio_view.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"

namespace relume {
namespace {

/// Two displays: view Half of the first one halves radiance, view Green of the second keeps only green.
constexpr const char* kConfig = R"(ocio_profile_version: 1
roles:
  default: lin
  scene_linear: lin
displays:
  screen:
    - !<View> {name: Raw, colorspace: lin}
    - !<View> {name: Half, colorspace: half}
  projector:
    - !<View> {name: Green, colorspace: green}
active_displays: []
active_views: []
colorspaces:
  - !<ColorSpace>
    name: lin
  - !<ColorSpace>
    name: half
    from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: green
    from_reference: !<MatrixTransform> {matrix: [0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]}
)";

class Ocio : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ocio_missing().empty()) GTEST_SKIP() << ocio_missing();
    write_file(folder_ / "a:b.ocio", kConfig);
  }

  std::string config() const { return (folder_ / "a:b.ocio").string(); }
  Image shown(const std::string& view, const Image& radiance, float exposure = 0) const {
    return OcioView(config(), view).apply(radiance, exposure);
  }
  static std::string sentence_of(const std::string& file, const std::string& name) {
    try {
      const OcioView view(file, name);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  TempFolder folder_;
};

Image pixel(const Rgb& value) {
  Image image(1, 1);
  image.at(0, 0) = value;
  return image;
}

TEST_F(Ocio, FilesHoldTheValuesOfTheView) {
  const Rgb stored = srgb_from_linear(shown("Half", pixel({0.2f, 0.8f, 5.0f})).at(0, 0));
  EXPECT_NEAR(stored.r, 0.1f, 1e-5f);
  EXPECT_NEAR(stored.g, 0.4f, 1e-5f);
  EXPECT_NEAR(stored.b, 1.0f, 1e-6f) << "clipped";
}

TEST_F(Ocio, ExposureComesFirst) {
  EXPECT_NEAR(srgb_from_linear(shown("Half", pixel(Rgb(0.1f)), 2).at(0, 0)).g, 0.2f, 1e-5f);
}

TEST_F(Ocio, ViewsOfAnyDisplayAreFound) {
  const Rgb value = shown("Green", pixel(Rgb(0.5f))).at(0, 0);
  EXPECT_EQ(value.r, 0);
  EXPECT_NEAR(srgb_from_linear(value.g), 0.5f, 1e-5f);
}

TEST_F(Ocio, EveryRowIsShown) {
  Image image(3, 50);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(static_cast<float>(i) / 200);
  const Image result = shown("Raw", image);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    EXPECT_NEAR(srgb_from_linear(result.pixels[i].r), image.pixels[i].r, 1e-5f) << i;
}

TEST_F(Ocio, NonFiniteIsBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(shown("Raw", pixel({nan, kInfinity, -1})).at(0, 0), Rgb(0));
}

TEST_F(Ocio, NotesTheColourSpaceThatReplacesLinearRec709) {
  EXPECT_EQ(OcioView(config(), "Raw").note(),
            config() +
                " has no linear Rec. 709 colour space; radiance is interpreted as its role scene_linear, which is "
                "'lin'");
  std::string named = kConfig;
  for (size_t at = named.find(" lin\n"); at != named.npos; at = named.find(" lin\n", at + 1))
    named.replace(at, 5, " lin_rec709\n");
  named.replace(named.find("colorspace: lin}"), 16, "colorspace: lin_rec709}");
  write_file(folder_ / "named.ocio", named);
  EXPECT_EQ(OcioView((folder_ / "named.ocio").string(), "Raw").note(), "");
}

TEST_F(Ocio, ListsTheFilesOfTheViewWhereTheyWereFound) {
  constexpr const char* kTable = "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n0\n0.5\n}\n";
  std::filesystem::create_directories(folder_ / "luts");
  write_file(folder_ / "luts" / "film.spi1d", kTable);
  write_file(folder_ / "luts" / "unused.spi1d", kTable);
  std::string config_with_files = kConfig;
  config_with_files.replace(config_with_files.find("roles:"), 0, "search_path: none:luts\n");
  const size_t at = config_with_files.find("!<MatrixTransform> {matrix: [0.5");
  config_with_files.replace(at, config_with_files.find('\n', at) - at, "!<FileTransform> {src: film.spi1d}");
  const std::string file = (folder_ / "files.ocio").string();
  write_file(file, config_with_files);
  EXPECT_EQ(OcioView(file, "Half").files(), std::vector{folder_ / "luts" / "film.spi1d"});
  EXPECT_TRUE(OcioView(file, "Green").files().empty());
}

TEST_F(Ocio, ErrorsAreOneSentence) {
  EXPECT_NE(sentence_of(config(), "Filmic").find("it has no view 'Filmic'; it has Green, Half, Raw"),
            std::string::npos);
  EXPECT_NE(sentence_of("no.ocio", "Raw").find("no.ocio: the OpenColorIO configuration cannot be used: "),
            std::string::npos);
  write_file(folder_ / "bad.ocio", "no: [profile");
  EXPECT_NE(sentence_of((folder_ / "bad.ocio").string(), "Raw").find("cannot be used"), std::string::npos);
}

}  // namespace
}  // namespace relume
