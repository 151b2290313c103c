#include "io/assimp/trial_run.h"

#include <atomic>
#include <csignal>
#include <stdexcept>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

constexpr uint64_t kMemory_bytes = uint64_t(256) << 20;

TEST(TrialRun, SaysWhetherTheTaskCameToAnEnd) {
  EXPECT_TRUE(survives_trial([] {}, 10, kMemory_bytes));
  EXPECT_TRUE(survives_trial([] { throw std::runtime_error("damaged"); }, 10, kMemory_bytes));
  EXPECT_FALSE(survives_trial([] { std::raise(SIGKILL); }, 10, kMemory_bytes));
}

TEST(TrialRun, EndsWhatNeverEnds) {
  EXPECT_FALSE(survives_trial(
      [] {
        std::atomic<int> turns = 0;
        while (true) ++turns;
      },
      1, kMemory_bytes));
}

TEST(TrialRun, EndsWithTheProcessThatBeganIt) {
  int ends[2];  // whoever lives holds the second one open
  ASSERT_EQ(pipe(ends), 0);
  const pid_t process = fork();
  ASSERT_GE(process, 0);
  if (process == 0) {
    survives_trial(
        [&] {
          [[maybe_unused]] const auto written = write(ends[1], "!", 1);
          while (true) pause();
        },
        10, kMemory_bytes);
    _exit(0);
  }
  close(ends[1]);
  char begun = 0;
  ASSERT_EQ(read(ends[0], &begun, 1), 1);
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
  pollfd end{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 10'000), 1) << "the trial goes on";
  EXPECT_EQ(read(ends[0], &begun, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace relume
