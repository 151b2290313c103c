#include "cli/preparation_progress.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "cli/scene_source.h"
#include "core/activity.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/image_io.h"

namespace relume::cli {
namespace {

void let_pass(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

/// Redirects standard error to a terminal during its lifetime.
class Terminal {
 public:
  /// `columns` 0: unknown width.
  explicit Terminal(unsigned short columns = 0) {
    const winsize size{.ws_row = 0, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    EXPECT_EQ(openpty(&master_, &slave_, nullptr, nullptr, &size), 0);
    std::fflush(stderr);
    saved_ = dup(STDERR_FILENO);
    dup2(slave_, STDERR_FILENO);
  }
  ~Terminal() {
    restore();
    close(master_);
  }

  /// Restores standard error and returns the text written.
  std::string text() {
    std::fputs("END", stderr);
    restore();
    std::string all;
    char buffer[4096];
    while (all.find("END") == all.npos) {
      const ssize_t count = read(master_, buffer, sizeof buffer);
      if (count <= 0) break;
      all.append(buffer, static_cast<size_t>(count));
    }
    return all;
  }

 private:
  void restore() {
    if (saved_ < 0) return;
    std::fflush(stderr);
    dup2(saved_, STDERR_FILENO);
    close(saved_);
    close(slave_);
    saved_ = -1;
  }

  int master_ = -1;
  int slave_ = -1;
  int saved_ = -1;
};

TEST(PreparationProgress, NamesSlowStepsOnATerminal) {
  Terminal terminal;
  {
    const PreparationProgress progress(true, 0.01);
    Activity activity("decoding textures", 12);
    activity.part_done();
    let_pass(400);
  }
  const std::string text = terminal.text();
  EXPECT_NE(text.find("\rdecoding textures, 1 of 12\x1b[K"), text.npos) << text;
  EXPECT_NE(text.find("\r\x1b[KEND"), text.npos) << "the line is removed";
}

TEST(PreparationProgress, CutsNamesBetweenCharacters) {
  Terminal terminal(11);
  {
    const PreparationProgress progress(true, 0.01);
    const Activity activity("loading K\u00fcche.glb");
    let_pass(400);
  }
  const std::string text = terminal.text();
  EXPECT_NE(text.find("\rloading K\u00fc\x1b[K"), text.npos) << text;
}

TEST(PreparationProgress, NamesEnvironmentMapsThatAreLoaded) {
  const TempFolder folder;
  write_image(folder / "whole.hdr", Image(2, 1));
  const std::vector<std::byte> bytes = read_file(folder / "whole.hdr");
  ASSERT_EQ(mkfifo((folder / "sky.hdr").c_str(), 0600), 0);
  Terminal terminal;
  const std::jthread sender([&] {
    std::ofstream out(folder / "sky.hdr", std::ios::binary);  // waits for the reader
    let_pass(static_cast<int>(1000 * PreparationProgress::kPatience_s) + 500);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  });
  Scene scene;
  SceneOverrides overrides;
  overrides.env = (folder / "sky.hdr").string();
  override_scene(overrides, scene, true);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::map);
  const std::string text = terminal.text();
  EXPECT_NE(text.find("\rloading sky.hdr\x1b[K"), text.npos) << text;
}

TEST(PreparationProgress, IsSilentForQuickSteps) {
  Terminal terminal;
  {
    const PreparationProgress progress(true, 100);
    const Activity activity("decoding textures");
    let_pass(50);
  }
  EXPECT_EQ(terminal.text(), "END");
}

TEST(PreparationProgress, IsSilentWithoutATerminal) {
  testing::internal::CaptureStderr();
  {
    const PreparationProgress progress(true, 0.001);
    const Activity activity("decoding textures");
    let_pass(50);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace relume::cli
