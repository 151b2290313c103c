#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/hash.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/group_by_key.h"
#include "frame/primitives/reduce.h"
#include "frame/primitives/scan.h"
#include "frame/primitives/testing/backends.h"

namespace relume {
namespace {

using testing::for_each_backend;

/// Sizes around the borders of lanes and blocks.
constexpr uint32_t kSizes[] = {0,
                               1,
                               kReduceLanes - 1,
                               kReduceLanes + 1,
                               kPrimitiveBlock - 1,
                               kPrimitiveBlock,
                               kPrimitiveBlock + 1,
                               10 * kPrimitiveBlock + 123};
/// The blocks of blocks do not fit into one.
constexpr uint32_t kThreeLevels = kPrimitiveBlock * kPrimitiveBlock + 1;

/// An array in the memory of a launch.
template <typename T>
Array<T> array_of(const PrimitiveLaunch& at, const std::vector<T>& values) {
  Array<T> array(at.backend.memory());
  array.assign(values);
  return array;
}

std::vector<uint32_t> random_words(uint32_t size, uint32_t below = 0) {
  std::vector<uint32_t> values(size);
  for (uint32_t i = 0; i < size; ++i) values[i] = below > 0 ? hash(i, size) % below : hash(i, size);
  return values;
}

/// Positive and negative, of very different sizes: each order of additions gives another sum.
std::vector<float> random_reals(uint32_t size) {
  std::vector<float> values(size);
  for (uint32_t i = 0; i < size; ++i) {
    const uint32_t h = hash(i, size, 7u);
    values[i] = std::ldexp(to_unit_float(h) - 0.5f, static_cast<int>(h % 32) - 16);
  }
  return values;
}

template <typename T>
uint64_t bits_of(T value) {
  if constexpr (std::is_same_v<T, float>) return std::bit_cast<uint32_t>(value);
  if constexpr (std::is_same_v<T, double>) return std::bit_cast<uint64_t>(value);
  if constexpr (std::is_integral_v<T>) return value;
}

/// The definition of a reduction: lanes of blocks, then the results of blocks in the same way.
template <typename Operation>
typename Operation::Value reduced(std::vector<typename Operation::Value> values) {
  using Value = typename Operation::Value;
  if (values.empty()) return Operation::identity();
  do {
    std::vector<Value> results;
    for (size_t begin = 0; begin < values.size(); begin += kPrimitiveBlock) {
      std::vector<Value> lanes(kReduceLanes, Operation::identity());
      const size_t end = std::min<size_t>(begin + kPrimitiveBlock, values.size());
      for (size_t i = begin; i < end; ++i) {
        Value& lane = lanes[(i - begin) % kReduceLanes];
        lane = Operation::combine(lane, values[i]);
      }
      for (; lanes.size() > 1; lanes.resize(lanes.size() / 2)) {
        for (size_t k = 0; k < lanes.size() / 2; ++k)
          lanes[k] = Operation::combine(lanes[k], lanes[k + lanes.size() / 2]);
      }
      results.push_back(lanes[0]);
    }
    values = results;
  } while (values.size() > 1);
  return values[0];
}

template <typename Operation, typename T>
void expect_defined_reduction(const std::vector<T>& values) {
  using Value = typename Operation::Value;
  const Value expected = reduced<Operation>(std::vector<Value>(values.begin(), values.end()));
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<T> array = array_of(at, values);
    const Value result = reduce<Operation>(at, Elements<T>{array.view()}, static_cast<uint32_t>(values.size()));
    EXPECT_EQ(bits_of(result), bits_of(expected)) << values.size() << " elements";
  });
}

void expect_exact_sum(uint32_t size) {
  const std::vector<uint32_t> values = random_words(size);
  const uint64_t expected = std::accumulate(values.begin(), values.end(), uint64_t{0});
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<uint32_t> array = array_of(at, values);
    EXPECT_EQ(sum(at, array.view()), expected) << size;
  });
}

TEST(Reduce, SumsOfIntegersAreExact) {
  for (const uint32_t size : kSizes) expect_exact_sum(size);
  expect_exact_sum(kThreeLevels);
}

TEST(Reduce, SumsOfRealNumbersHaveTheSameBitsInAllForms) {
  for (const uint32_t size : kSizes) {
    expect_defined_reduction<Sum<float>>(random_reals(size));
    expect_defined_reduction<Sum<double>>(random_reals(size));
  }
  expect_defined_reduction<Sum<float>>(random_reals(kThreeLevels));
}

TEST(Reduce, SumsOfRealNumbersAreAccurate) {
  const std::vector<float> values(3 * kPrimitiveBlock * kPrimitiveBlock, 0.1f);
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<float> array = array_of(at, values);
    const float result = reduce<Sum<float>>(at, Elements<float>{array.view()}, array.view().size);
    EXPECT_NEAR(result, 0.1f * static_cast<float>(values.size()), 1e-6f * static_cast<float>(values.size()));
  });
}

TEST(Reduce, FindsMinimaAndMaxima) {
  for (const uint32_t size : kSizes) {
    expect_defined_reduction<Min<uint32_t>>(random_words(size));
    expect_defined_reduction<Max<uint32_t>>(random_words(size));
    expect_defined_reduction<Min<float>>(random_reals(size));
    expect_defined_reduction<Max<float>>(random_reals(size));
  }
}

TEST(Reduce, MinimaAndMaximaIgnoreNan) {
  std::vector<float> values(100, std::numeric_limits<float>::quiet_NaN());
  const auto both = [&](float lowest, float highest) {
    for_each_backend([&](const PrimitiveLaunch& at) {
      const Array<float> array = array_of(at, values);
      EXPECT_EQ(reduce<Min<float>>(at, Elements<float>{array.view()}, array.view().size), lowest);
      EXPECT_EQ(reduce<Max<float>>(at, Elements<float>{array.view()}, array.view().size), highest);
    });
  };
  const float infinity = std::numeric_limits<float>::infinity();
  both(infinity, -infinity);
  values[70] = 5;
  values[3] = -2;
  both(-2, 5);
}

TEST(AnyOf, FindsOneElement) {
  for (const uint32_t size : kSizes) {
    std::vector<uint32_t> values(size, 0);
    const auto expect = [&](bool found) {
      for_each_backend([&](const PrimitiveLaunch& at) {
        const Array<uint32_t> array = array_of(at, values);
        EXPECT_EQ(any_of(at, Elements<uint32_t>{array.view()}, size), found) << size;
      });
    };
    expect(false);
    if (size == 0) continue;
    values[hash(size) % size] = 0x80000000u;
    expect(true);
  }
}

void expect_prefix_sums(uint32_t size) {
  const std::vector<uint32_t> values = random_words(size, 1000);
  std::vector<uint32_t> expected(size);
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
  const uint64_t total = std::accumulate(values.begin(), values.end(), uint64_t{0});
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<uint32_t> input = array_of(at, values);
    Array<uint32_t> sums(at.backend.memory());
    sums.reset(size, kUninitialized);
    EXPECT_EQ(exclusive_scan(at, Elements<uint32_t>{input.view()}, sums.mutable_view()), total) << size;
    EXPECT_TRUE(std::ranges::equal(sums.read(), expected)) << size;
    Array<uint32_t> in_place = input;
    EXPECT_EQ(exclusive_scan(at, in_place.mutable_view()), total) << size;
    EXPECT_TRUE(std::ranges::equal(in_place.read(), expected)) << size;
  });
}

TEST(ExclusiveScan, IsTheSequentialPrefixSum) {
  for (const uint32_t size : kSizes) expect_prefix_sums(size);
  expect_prefix_sums(kThreeLevels);
}

TEST(ExclusiveScan, ReturnsTotalsBeyond32Bits) {
  for_each_backend([](const PrimitiveLaunch& at) {
    Array<uint32_t> sums = array_of(at, std::vector<uint32_t>(3 * kPrimitiveBlock, 0xffffffffu));
    EXPECT_EQ(exclusive_scan(at, sums.mutable_view()), uint64_t{0xffffffffu} * sums.size());
    EXPECT_EQ(sums.read()[2], 0xfffffffeu);
  });
}

void expect_stable_groups(const std::vector<uint32_t>& keys, uint32_t key_count) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < keys.size(); ++i)
    if (keys[i] < key_count) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return keys[a] < keys[b]; });
  std::vector<uint32_t> begins;
  for (uint32_t key = 0, next = 0; key <= key_count; ++key) {
    while (next < order.size() && keys[order[next]] < key) ++next;
    begins.push_back(next);
  }
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<uint32_t> input = array_of(at, keys);
    KeyGroups groups(at.backend.memory());
    for (int use = 0; use < 2; ++use) {  // reused, as between frames
      ASSERT_TRUE(group_by_key(at, Elements<uint32_t>{input.view()}, input.view().size, key_count, groups));
      EXPECT_TRUE(std::ranges::equal(groups.order.read(), order)) << keys.size() << " keys below " << key_count;
      EXPECT_TRUE(std::ranges::equal(groups.begins.read(), begins)) << keys.size() << " keys below " << key_count;
    }
  });
}

TEST(GroupByKey, IsAStableSort) {
  const uint32_t part = key_part_size(1, KernelForm::host);
  for (const uint32_t key_count : {1u, 7u, kPrimitiveBlock, 5000u}) {
    for (const uint32_t size : {0u, 1u, kPrimitiveBlock - 1, kPrimitiveBlock + 1, part - 1, part, part + 1, 10 * part})
      expect_stable_groups(random_words(size, key_count), key_count);
  }
}

TEST(GroupByKey, LeavesOutKeysFromTheBoundOn) {
  std::vector<uint32_t> keys = random_words(100'000, 300);
  keys[0] = keys[99'999] = 0xffffffffu;
  for (const uint32_t key_count : {0u, 1u, 100u, 299u}) expect_stable_groups(keys, key_count);
}

TEST(GroupByKey, TakesGroupsOfVeryDifferentSizes) {
  std::vector<uint32_t> keys(200'000, 17);
  for (uint32_t i = 0; i < keys.size(); i += 1000) keys[i] = hash(i) % 2000;
  expect_stable_groups(keys, 2000);
}

TEST(Fill, SetsAndCopiesAllElements) {
  for (const uint32_t size : {0u, 1u, kFillTile - 1, kFillTile, kFillTile + 1, 5 * kFillTile + 3}) {
    for_each_backend([&](const PrimitiveLaunch& at) {
      const Array<uint32_t> from = array_of(at, random_words(size));
      Array<uint32_t> to(at.backend.memory());
      to.reset(size_t{size} + 1);
      EXPECT_TRUE(fill(at.backend, at.name, View<uint32_t>{to.mutable_view().data, size}, 5u));
      EXPECT_EQ(std::ranges::count(to.read(), 5u), size);
      EXPECT_TRUE(copy(at.backend, at.name, from.view(), to.mutable_view()));
      EXPECT_TRUE(std::ranges::equal(to.read().first(size), from.read()));
      EXPECT_EQ(to.read()[size], 0u);
    });
  }
}

TEST(Fill, TakesElementsAtAStride) {
  for (const uint32_t stride : {1u, 3u, 31u, 999u, 1000u}) {
    for_each_backend([&](const PrimitiveLaunch& at) {
      const Array<uint32_t> from = array_of(at, random_words(1000));
      Array<uint32_t> to(at.backend.memory());
      to.reset(999 / stride + 1);
      take_elements(at.backend, at.name, from.view(), stride, to.mutable_view());
      for (uint32_t i = 0; i < to.size(); ++i) EXPECT_EQ(to.read()[i], from.read()[size_t{i} * stride]);
    });
  }
}

TEST(Fill, ChangesTheSizeOfArrays) {
  for_each_backend([](const PrimitiveLaunch& at) {
    Array<uint32_t> array = array_of<uint32_t>(at, {1, 2, 3});
    resize(at.backend, at.name, array, 5);
    EXPECT_TRUE(std::ranges::equal(array.read(), std::vector<uint32_t>{1, 2, 3, 0, 0}));
    resize(at.backend, at.name, array, 2);
    EXPECT_TRUE(std::ranges::equal(array.read(), std::vector<uint32_t>{1, 2}));
    Array<uint32_t> other(at.backend.memory());
    copy(at.backend, at.name, array, other);
    EXPECT_TRUE(std::ranges::equal(other.read(), array.read()));
    reset(at.backend, at.name, array, 3, 7u);
    EXPECT_TRUE(std::ranges::equal(array.read(), std::vector<uint32_t>{7, 7, 7}));
    reset(at.backend, at.name, array, 0);
    copy(at.backend, at.name, array, other);
    EXPECT_TRUE(other.empty());
  });
}

TEST(Fill, KeepsTheSizeOfAnArrayIfItFails) {
  for_each_backend([](const PrimitiveLaunch& at) {
    Array<uint32_t> array = array_of<uint32_t>(at, {1, 2, 3});
    at.backend.on_launch([](const LaunchEvent&) { throw std::runtime_error("no launch"); });
    EXPECT_THROW(resize(at.backend, at.name, array, 5), std::runtime_error);
    EXPECT_TRUE(std::ranges::equal(array.read(), std::vector<uint32_t>{1, 2, 3}));
  });
}

TEST(Primitives, Stop) {
  const uint32_t size = 10 * kPrimitiveBlock + 1;
  std::stop_source source;
  source.request_stop();
  const std::stop_token stop = source.get_token();
  for_each_backend([&](const PrimitiveLaunch& at) {
    const Array<uint32_t> values = array_of(at, random_words(size, 100));
    const Elements<uint32_t> input{values.view()};
    KeyGroups groups(at.backend.memory());
    Array<uint32_t> sums = values;
    EXPECT_FALSE(reduce_or_stop<Sum<uint64_t>>(at, input, size, stop));
    EXPECT_FALSE(exclusive_scan_or_stop(at, input, sums.mutable_view(), stop));
    EXPECT_FALSE(group_by_key(at, input, size, 100, groups, stop));
    EXPECT_FALSE(fill(at.backend, at.name, sums.mutable_view(), 0u, stop));
    EXPECT_FALSE(copy(at.backend, at.name, values.view(), sums.mutable_view(), stop));
    EXPECT_TRUE(std::ranges::equal(sums.read(), values.read()));
  });
}

TEST(Primitives, StopAtAnyTile) {
  for_each_backend([](const PrimitiveLaunch& at) {
    const Array<uint32_t> keys = array_of(at, random_words(100'000, 100));
    for (int tiles = 0;; ++tiles) {
      std::stop_source source;
      std::atomic<int> left{tiles};
      at.backend.on_tile([&] {
        if (left.fetch_sub(1) <= 0) source.request_stop();
      });
      KeyGroups groups(at.backend.memory());
      if (group_by_key(at, Elements<uint32_t>{keys.view()}, 100'000, 100, groups, source.get_token())) {
        EXPECT_GE(tiles, 4);  // each launch can be stopped; on a device, each may be one band
        EXPECT_EQ(groups.begins.read()[100], 100'000u);
        break;
      }
    }
    at.backend.on_tile({});
  });
}

TEST(Primitives, AddTimesUnderTheirCallersNames) {
  for_each_backend([](const PrimitiveLaunch& at) {
    const Array<uint32_t> values = array_of(at, random_words(100'000, 10));
    KeyGroups groups(at.backend.memory());
    sum({at.backend, "one", at.scratch}, values.view());
    group_by_key(PrimitiveLaunch{at.backend, "two", at.scratch}, Elements<uint32_t>{values.view()}, 100'000, 10,
                 groups);
    ASSERT_EQ(at.backend.times().size(), 2u);
    EXPECT_EQ(at.backend.times()[0].name, "one");
    EXPECT_EQ(at.backend.times()[1].name, "two");
  });
}

TEST(Primitives, KeepTheirMemory) {
  for_each_backend([](const PrimitiveLaunch& at) {
    const Array<uint32_t> values = array_of(at, random_words(100'000, 10));
    KeyGroups groups(at.backend.memory());
    const auto run = [&](uint32_t size) {
      group_by_key(at, Elements<uint32_t>{values.view()}, size, 10, groups);
      return std::pair(groups.order.view().data, at.scratch.memory_bytes());
    };
    const auto first = run(100'000);
    EXPECT_GT(first.second, 0u);
    EXPECT_EQ(run(10), first);
    EXPECT_EQ(run(100'000), first);
  });
}

}  // namespace
}  // namespace relume
