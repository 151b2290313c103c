// Blocks of threads in the PTX executor: order, barriers, memories, faults.
#include <gtest/gtest.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "runtime/launch.h"

namespace ptx {

extern const Module blocks;

namespace {

constexpr uint32_t kSeeds = 20;

/// Launches a kernel of blocks.ptx with the given values as parameters.
template <typename... T>
void run(const std::string& name, const Launch& launch, T... parameters) {
  void* addresses[] = {&parameters..., nullptr};
  run_grid(blocks, blocks.entry(name), launch, addresses);
}

Launch launch_of(uint32_t grid, uint32_t block, uint64_t seed = 0) {
  Launch launch;
  launch.grid.x = grid;
  launch.block.x = block;
  launch.seed = seed;
  return launch;
}

/// Message of the Fault that a launch ends with.
template <typename... T>
std::string fault_of(const std::string& name, const Launch& launch, T... parameters) {
  try {
    run(name, launch, parameters...);
  } catch (const Fault& fault) {
    return fault.what();
  }
  return "no fault";
}

/// Sums of three blocks, by a kernel with the signature of block_sum.
std::vector<uint32_t> block_sums(const std::string& name, uint64_t seed) {
  std::vector<uint32_t> in(3 * 256);
  std::iota(in.begin(), in.end(), 1u);
  std::vector<uint32_t> out(3);
  run(name, launch_of(3, 256, seed), in.data(), out.data());
  return out;
}

TEST(Barriers, MakeAReductionRightInAnyOrder) {
  const std::vector<uint32_t> expected{256 * 257 / 2, 256 * 257 / 2 + 256 * 256, 256 * 257 / 2 + 2 * 256 * 256};
  for (uint32_t seed = 0; seed < kSeeds; ++seed) EXPECT_EQ(block_sums("block_sum", seed), expected) << seed;
}

TEST(Barriers, AMissingOneChangesTheResult) {
  const auto expected = block_sums("block_sum", 0);
  uint32_t different = 0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed)
    different += block_sums("block_sum_without_barriers", seed) != expected;
  EXPECT_EQ(different, kSeeds);
}

TEST(Barriers, DoNotWaitForThreadsThatHaveEnded) {
  std::vector<uint32_t> out(64);
  run("some_end_early", launch_of(1, 64), 20u, out.data());
  EXPECT_EQ(std::count(out.begin(), out.begin() + 20, 1u), 20);
  EXPECT_EQ(std::count(out.begin(), out.end(), 1u), 20);
}

TEST(Barriers, OfDifferentNumbersAreIndependent) {
  std::vector<uint32_t> out(96);
  run("named_barriers", launch_of(1, 96), out.data());
  EXPECT_EQ(std::count(out.begin(), out.end(), 1u), 96);
}

TEST(Barriers, ThatNotAllThreadsReachAreFaults) {
  EXPECT_EQ(fault_of("deadlock", launch_of(1, 64)),
            "deadlock: in block (0, 0, 0), 64 of 64 threads wait for others that never come");
}

TEST(Order, IsShuffledByTheSeed) {
  const Symbol& counter = blocks.symbol("counter");
  std::set<std::vector<uint32_t>> orders;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    *static_cast<uint32_t*>(counter.address) = 0;
    std::vector<uint32_t> order(6 * 32);
    run("order", launch_of(6, 32, seed), order.data());
    orders.insert(order);
    std::sort(order.begin(), order.end());
    for (uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
  }
  EXPECT_EQ(orders.size(), kSeeds);
}

TEST(SpecialRegisters, FollowTheLaunch) {
  Launch launch;
  launch.grid = {2, 1, 3};
  launch.block = {5, 4, 2};
  std::vector<uint32_t> out(6 * 40 * 20);
  run("special", launch, out.data());
  for (uint32_t i = 0; i < 6 * 40; ++i) {
    const uint32_t block = i / 40;
    const uint32_t thread = i % 40;
    const uint32_t lane = thread % 32;
    const uint32_t lower = (1u << lane) - 1;
    const std::vector<uint32_t> expected{thread % 5,
                                         thread / 5 % 4,
                                         thread / 20,
                                         5,
                                         4,
                                         2,
                                         block % 2,
                                         0,
                                         block / 2,
                                         2,
                                         1,
                                         3,
                                         lane,
                                         thread / 32,
                                         1u << lane,
                                         lower,
                                         2 * lower + 1,
                                         ~(2 * lower + 1),
                                         ~lower,
                                         32};
    EXPECT_EQ(std::vector<uint32_t>(out.begin() + i * 20, out.begin() + (i + 1) * 20), expected) << i;
  }
}

TEST(Memories, AreConstantsThatTheHostMaySetAndSharedMemoryWithoutValues) {
  std::vector<uint32_t> out(2);
  Launch launch;
  launch.dynamic_shared_bytes = 16;
  run("memories", launch, 5u, out.data());
  EXPECT_EQ(out, (std::vector<uint32_t>{15, 0xffffffff}));
  const Symbol& factor = blocks.symbol("factor");
  EXPECT_EQ(factor.bytes, 4u);
  *static_cast<uint32_t*>(factor.address) = 7;
  run("memories", launch, 5u, out.data());
  EXPECT_EQ(out[0], 35u);
  *static_cast<uint32_t*>(factor.address) = 3;
}

#if defined(__SSE__)
TEST(Arithmetic, KeepsDenormalNumbersWhereTheCallerFlushesThem) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);  // flush to zero, denormals are zero
  float out = 0;
  run("multiply", Launch{}, 0x1p-100f, 0x1p-40f, &out);
  EXPECT_EQ(_mm_getcsr() & 0x8040, 0x8040u);
  _mm_setcsr(before);
  EXPECT_EQ(out, 0x1p-140f);
}
#endif

TEST(Faults, AreMisalignedAddresses) {
  alignas(8) unsigned char bytes[16] = {};
  const auto address = reinterpret_cast<uintptr_t>(bytes) + 2;
  EXPECT_EQ(fault_of("multiply", Launch{}, 1.0f, 1.0f, address),
            "address " + std::to_string(address) + " is not a multiple of 4");
}

TEST(Faults, AreShufflesFromThreadsThatTakeNoPart) {
  uint32_t out = 0;
  EXPECT_EQ(fault_of("reads_from_outside", launch_of(1, 32), &out),
            "a shuffle reads from lane 20, which takes no part");
  EXPECT_EQ(fault_of("is_no_member", launch_of(1, 32), &out),
            "is_no_member: a thread is not among the members that it names");
}

TEST(Faults, AreNamesAndBlocksThatDoNotExist) {
  EXPECT_EQ(fault_of("nothing", Launch{}), "the module has no entry 'nothing'");
  EXPECT_THROW(blocks.symbol("nothing"), Fault);
  EXPECT_EQ(fault_of("deadlock", launch_of(1, 2048)), "a block has 1 to 1024 threads, not 2048");
  EXPECT_EQ(fault_of("deadlock", launch_of(1, 0)), "a block has 1 to 1024 threads, not 0");
}

}  // namespace
}  // namespace ptx
