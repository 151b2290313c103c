#include "viewer/model/file_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "files/testing/temp_folder.h"

namespace relume::viewer {
namespace {

namespace fs = std::filesystem;

class FileWatchTest : public ::testing::Test {
 protected:
  FileWatchTest() {
    write("scene.gltf", "one");
    write("scene.bin", "one");
    watch_.watch({folder_ / "scene.gltf", folder_ / "scene.bin", folder_ / "missing.png"});
    EXPECT_FALSE(passes(2));
  }
  void write(const char* name, const char* text) {
    std::ofstream(folder_ / name) << text;
    // File systems' clocks are coarse.
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() + std::chrono::seconds(++writes_));
  }
  /// Whether a change is reported within `seconds`.
  bool passes(double seconds) {
    bool changed = false;
    for (const double end_s = now_s_ + seconds; now_s_ < end_s; now_s_ += 0.05) changed |= watch_.changed(now_s_);
    return changed;
  }

  TempFolder folder_;
  FileWatch watch_;
  double now_s_ = 0;
  int writes_ = 0;
};

TEST_F(FileWatchTest, SeesAChangeOfAnyFileOnce) {
  for (const char* name : {"scene.gltf", "scene.bin", "missing.png"}) {
    write(name, "two");
    EXPECT_TRUE(passes(2)) << name;
    EXPECT_FALSE(passes(2)) << name;
  }
}

TEST_F(FileWatchTest, WaitsUntilFilesSettle) {
  for (int piece = 0; piece < 10; ++piece) {
    write("scene.gltf", "piece");
    EXPECT_FALSE(passes(0.3)) << piece;
  }
  EXPECT_TRUE(passes(2));
}

TEST_F(FileWatchTest, WaitsForTheSceneToReappear) {
  fs::remove(folder_ / "scene.gltf");
  EXPECT_FALSE(passes(5));
  write("scene.gltf", "two");
  EXPECT_TRUE(passes(2));
}

TEST_F(FileWatchTest, DeletedFilesAreChanges) {
  fs::remove(folder_ / "scene.bin");
  EXPECT_TRUE(passes(2));
}

TEST_F(FileWatchTest, RemembersFilesThatAreWatchedAgain) {
  write("scene.bin", "three");
  watch_.watch({folder_ / "scene.gltf", folder_ / "scene.bin"});
  EXPECT_TRUE(passes(2)) << "it changed before it was read again";
  write("missing.png", "two");
  EXPECT_FALSE(passes(2)) << "no longer watched";
}

TEST_F(FileWatchTest, SettlingChangesSurviveANewFileList) {
  write("scene.bin", "two");
  EXPECT_FALSE(passes(0.35)) << "seen, but not for long enough";
  watch_.watch({folder_ / "scene.gltf"});
  EXPECT_TRUE(passes(2));
  write("scene.bin", "three");
  EXPECT_FALSE(passes(0.35));
  write("other.gltf", "one");
  watch_.watch({folder_ / "other.gltf"});
  EXPECT_FALSE(passes(2)) << "another scene";
}

TEST_F(FileWatchTest, DetectsChangesDuringReading) {
  const auto read_from = fs::file_time_type::clock::now() + std::chrono::seconds(writes_);
  const std::vector<fs::path> files{folder_ / "scene.gltf", folder_ / "scene.bin"};
  for (const bool changes : {false, true}) {
    if (changes) write("scene.bin", "while it is read");
    watch_ = {};
    watch_.watch(files, read_from);
    EXPECT_EQ(passes(2), changes);
    EXPECT_FALSE(passes(2));
  }
}

TEST(FileWatch, WithoutFilesNothingChanges) {
  FileWatch watch;
  watch.watch({});
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(watch.changed(i));
}

}  // namespace
}  // namespace relume::viewer
