#include "image/exr_rows.h"

#include <bit>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

constexpr int kWidth = 20;
constexpr int kHeight = 37;

ExrLayout layout_of(const PixelWindow& window) {
  return {kWidth, kHeight, window, {{"Y", false}, {"words.0", true}}, {{"relume.text", "a b"}}};
}

/// The words of one row: floats by their bits, then integers.
std::vector<uint32_t> row_words(int y, int width) {
  std::vector<uint32_t> words;
  for (int x = 0; x < width; ++x) words.push_back(std::bit_cast<uint32_t>(static_cast<float>(y) + 0.25f * x));
  for (int x = 0; x < width; ++x) words.push_back(0xfffffff0u - static_cast<uint32_t>(100 * y + x));
  return words;
}

void write_rows(const std::filesystem::path& file, const PixelWindow& window) {
  ExrRowWriter writer(file, layout_of(window));
  for (int y = 0; y < window.height; ++y) writer.write(1, row_words(y, window.width));
  writer.commit();
}

TEST(ExrRows, ReadWhatTheyWrite) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "rows.exr";
  for (const PixelWindow& window : {PixelWindow{0, 0, kWidth, kHeight}, PixelWindow{3, 5, 7, 20}}) {
    write_rows(file, window);
    ExrRowReader reader(file);
    EXPECT_EQ(reader.layout().width, kWidth);
    EXPECT_EQ(reader.layout().height, kHeight);
    EXPECT_EQ(reader.layout().window, window);
    EXPECT_EQ(reader.layout().channels, layout_of(window).channels);
    EXPECT_EQ(reader.layout().attributes.at("relume.text"), "a b");
    std::vector<uint32_t> words(static_cast<size_t>(2 * window.width));
    for (const int y : {window.height - 1, 0, 11}) {
      reader.read(y, 1, words);
      EXPECT_EQ(words, row_words(y, window.width)) << y;
    }
  }
}

TEST(ExrRows, AreReadByTheOtherReader) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "rows.exr";
  write_rows(file, {0, 0, kWidth, kHeight});
  const ExrFile exr = read_exr(file);
  ASSERT_NE(exr.find("Y"), nullptr);
  EXPECT_EQ(exr.find("Y")->values[2 * kWidth + 4], 3.0f);
}

TEST(ExrRows, RefuseFilesThatAreCutOff) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "rows.exr";
  write_rows(file, {0, 0, kWidth, kHeight});
  const auto size = std::filesystem::file_size(file);
  for (uintmax_t kept = 0; kept < size; kept += 97) {
    write_rows(file, {0, 0, kWidth, kHeight});
    std::filesystem::resize_file(file, kept);
    const auto read_all = [&] {
      ExrRowReader reader(file);
      std::vector<uint32_t> words(size_t{2} * kWidth * kHeight);
      reader.read(0, kHeight, words);
    };
    EXPECT_THROW(read_all(), Error) << kept;
  }
}

TEST(ExrRows, LeaveTheTargetWithoutACommit) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "rows.exr";
  {
    ExrRowWriter writer(file, layout_of({0, 0, kWidth, kHeight}));
    writer.write(1, row_words(0, kWidth));
  }
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace relume
