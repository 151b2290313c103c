#include "scene_io/assimp/trial_run.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;

constexpr TrialLimits kLimits = {10, 20, uint64_t(256) << 20};

/// Message of the task's Error.
std::string problem_of(const std::function<void()>& task, const TrialLimits& limits = kLimits) {
  return error_of([&] {
    run_trial(
        [&] {
          task();
          return Bytes();
        },
        limits, "a.dae");
  });
}

/// Checks that the message names a.dae and contains `part`.
void expect_says(const std::string& message, const std::string& part) {
  EXPECT_EQ(message.rfind("a.dae: ", 0), 0u) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

/// Allocates until the process ends, catching exceptions as some libraries do.
void exhaust_memory() {
  constexpr size_t kBlock = size_t{16} << 20;
  std::vector<std::unique_ptr<char[]>> blocks;
  try {
    while (true) {
      blocks.push_back(std::make_unique_for_overwrite<char[]>(kBlock));
      std::memset(blocks.back().get(), 1, kBlock);
    }
  } catch (const std::bad_alloc&) {
  }
}

TEST(TrialRun, ReturnsTheResultOfTheTask) {
  Bytes large(size_t{40} << 20);
  for (size_t i = 0; i < large.size(); ++i) large[i] = static_cast<std::byte>(i * 2654435761u >> 24);
  EXPECT_EQ(run_trial([&] { return large; }, kLimits, "a.dae"), large);
  EXPECT_TRUE(run_trial([] { return Bytes(); }, kLimits, "a.dae").empty());
}

/// Limits file sizes during its lifetime.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(TrialRun, ReturnsMoreThanAFileMayHold) {
  const FileSizeLimit limit(1000);
  const Bytes large(size_t{1} << 20, std::byte{7});
  EXPECT_EQ(run_trial([&] { return large; }, kLimits, "a.dae"), large);
}

TEST(TrialRun, ReportsResultsThatCannotBeReturned) {
  const std::string message = error_of([] {
    run_trial(
        [] {
          for (int descriptor = 3; descriptor < 256; ++descriptor) close(descriptor);
          return Bytes(1);
        },
        kLimits, "a.dae");
  });
  expect_says(message, "could not return its result");
}

TEST(TrialRun, ReportsCrashes) {
  expect_says(problem_of([] { std::raise(SIGSEGV); }), "crashed (signal 11)");
  expect_says(problem_of([] { throw std::runtime_error("damaged"); }), "crashed");
  expect_says(problem_of([] { std::raise(SIGKILL); }), "the system ended the process");
  expect_says(problem_of([] { std::raise(SIGINT); }), "interrupted");
}

/// Peak memory of the largest child so far, in KiB.
long largest_child_kib() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  return children.ru_maxrss;
}

TEST(TrialRun, LimitsMemory) {
  constexpr long kGibibyte_KiB = 1 << 20;
  const long before = largest_child_kib();
  expect_says(problem_of(exhaust_memory), "more than 256 MiB of memory");
  EXPECT_LE(largest_child_kib(), std::max(before, kGibibyte_KiB));
}

TEST(TrialRun, LimitsProcessorTime) {
  expect_says(problem_of(
                  [] {
                    std::atomic<int> turns = 0;
                    while (true) ++turns;
                  },
                  {1, 60, kLimits.memory_bytes}),
              "more than 1 s of processor time");
}

TEST(TrialRun, LimitsElapsedTime) {
  const double start_s = now_s();
  expect_says(problem_of(
                  [] {
                    while (true) pause();
                  },
                  {10, 1, kLimits.memory_bytes}),
              "longer than 1 s");
  EXPECT_LT(now_s() - start_s, 5);
}

TEST(TrialRun, KeepsIgnoredInterrupts) {
  const auto interrupted = [] { return problem_of([] { raise(SIGINT); }); };
  EXPECT_NE(interrupted(), "");
  const auto handler = std::signal(SIGINT, SIG_IGN);
  EXPECT_EQ(interrupted(), "");
  std::signal(SIGINT, handler);
}

TEST(TrialRun, EndsWithItsParentProcess) {
  int ends[2];  // every living process holds the second one open
  ASSERT_EQ(pipe(ends), 0);
  const pid_t process = fork();
  ASSERT_GE(process, 0);
  if (process == 0) {
    problem_of([&] {
      [[maybe_unused]] const auto written = write(ends[1], "!", 1);
      while (true) pause();
    });
    _exit(0);
  }
  close(ends[1]);
  char begun = 0;
  ASSERT_EQ(read(ends[0], &begun, 1), 1);
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
  pollfd end{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 10'000), 1) << "the trial still runs";
  EXPECT_EQ(read(ends[0], &begun, 1), 0);
  close(ends[0]);
}

bool g_kills_parent = false;

/// Runs first in children of fork().
void kill_parent() {
  if (!g_kills_parent) return;
  const pid_t parent = getppid();
  kill(parent, SIGKILL);
  while (getppid() == parent) usleep(1000);
}

TEST(TrialRun, DoesNotBeginOnceItsParentProcessIsGone) {
  ASSERT_EQ(pthread_atfork(nullptr, nullptr, kill_parent), 0);
  int ends[2];  // every living process holds the second one open
  ASSERT_EQ(pipe(ends), 0);
  const pid_t process = fork();
  ASSERT_GE(process, 0);
  if (process == 0) {
    g_kills_parent = true;
    problem_of([&] { [[maybe_unused]] const auto written = write(ends[1], "!", 1); });
    _exit(0);
  }
  close(ends[1]);
  waitpid(process, nullptr, 0);
  pollfd end{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 10'000), 1);
  char begun = 0;
  EXPECT_EQ(read(ends[0], &begun, 1), 0) << "the trial has begun";
  close(ends[0]);
}

}  // namespace
}  // namespace relume
