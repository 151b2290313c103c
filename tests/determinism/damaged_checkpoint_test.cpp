// Tests checkpoints with damaged bytes and a valid checksum: the result is an Error or a session that continues. This
// is the short form of scripts/fuzz, for every technique with its own state.
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "../fuzz/checkpoint_case.h"
#include "relume/error.h"
#include "testing/random.h"

namespace relume {
namespace {

class DamagedCheckpoint : public ::testing::TestWithParam<int> {
 protected:
  DamagedCheckpoint()
      : file_(std::filesystem::temp_directory_path() /
              ("relume_damaged_" + std::to_string(getpid()) + "_" + std::to_string(GetParam()))) {}
  ~DamagedCheckpoint() override { std::filesystem::remove(file_); }

  std::string saved() const {
    Session session = fuzz::checkpoint_session(GetParam());
    for (int i = 0; i < 4; ++i) session.render_frame();
    session.save_checkpoint(file_);
    const std::string bytes = fuzz::contents(file_);
    return bytes.substr(0, bytes.size() - sizeof(uint64_t));
  }
  /// Whether the checkpoint was accepted; then renders two frames.
  bool goes_on(const std::string& checkpoint) const {
    std::ofstream(file_, std::ios::binary) << checkpoint << fuzz::checksum(checkpoint);
    Session session = fuzz::checkpoint_session(GetParam());
    try {
      session.load_checkpoint(file_);
    } catch (const Error&) {
      return false;
    }
    for (int i = 0; i < 2; ++i) session.render_frame();
    return true;
  }

  const std::filesystem::path file_;
};

TEST_P(DamagedCheckpoint, IsRejectedOrContinues) {
  const std::string checkpoint = saved();
  ASSERT_TRUE(goes_on(checkpoint));
  const size_t header = fuzz::header_size(checkpoint);
  testing::Random random(static_cast<uint32_t>(GetParam()));
  const auto below = [&](size_t n) { return static_cast<size_t>(random.next() * static_cast<float>(n)); };
  for (int i = 0; i < 48; ++i) {
    std::string damaged = checkpoint;
    const uint32_t words[] = {0xffffffffu, 0, static_cast<uint32_t>(below(1000)), 1u << below(31)};
    const size_t at = header + (below(damaged.size() - header - 8) & ~size_t{3});
    const size_t count = i % 3 == 0 ? 4 : 1;  // whole quadtrees, or single numbers
    for (size_t k = 0; k < count && at + 4 * k + 4 <= damaged.size(); ++k)
      std::memcpy(damaged.data() + at + 4 * k, &words[i % 4], sizeof(uint32_t));
    goes_on(damaged);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, DamagedCheckpoint, ::testing::Range(0, fuzz::kCheckpointCases));

}  // namespace
}  // namespace relume
