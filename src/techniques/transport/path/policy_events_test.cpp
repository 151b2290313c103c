// Tests which policies receive the events of a modifying policy.
#include <gtest/gtest.h>

#include <string>

#include "techniques/transport/path/path.h"

namespace relume {
namespace {

/// Notes the hooks and events in order.
struct Listener : NoPolicy {
  std::string* notes = nullptr;
  char name = 'a';

  void note(const char* what) const { *notes += std::string(1, name) + what + " "; }
  bool arrived(const SurfacePoint&, const PathState&) {
    note("+arrived");
    return true;
  }
  void rebased(const Rgb&, const Rgb&) const { note(".rebased"); }
  void ended_in_cell(const Rgb&) const { note(".cell"); }
  void survived(float) const { note(".survived"); }
  void culled() const { note(".culled"); }
};

/// Reports an event in each hook.
struct Reporter : NoPolicy {
  bool continues = true;

  template <typename Earlier>
  bool arrived(SurfacePoint&, PathState&, Earlier& earlier) {
    earlier.rebased(Rgb(0), Rgb(1));
    return true;
  }
  template <typename Earlier>
  bool goes_on(PathState&, Earlier& earlier) {
    earlier.ended_in_cell(Rgb(1));
    if (!continues) earlier.culled();
    return continues;
  }
  template <typename Earlier>
  void scattered(const SurfacePoint&, const BsdfSample&, PathState&, Earlier& earlier) {
    earlier.survived(0.5f);
  }
};

using Alone = PathPolicies<Reporter>;
using Between = PathPolicies<Listener, Listener, Reporter, Listener>;
static_assert(DecidesLater<Reporter> && DecidesLater<Alone> && DecidesLater<Between>);
static_assert(!DecidesLater<NoPolicy> && !DecidesLater<PathPolicies<Listener, Listener>>);

TEST(PolicyEvents, ReachThePoliciesBefore) {
  for (const bool continues : {true, false}) {
    std::string notes;
    Between policies{{{}, &notes, 'a'}, {{{}, &notes, 'b'}, {{{}, continues}, {{{}, &notes, 'c'}, {}}}}};
    SurfacePoint sp{};
    PathState path;
    EXPECT_TRUE(policies.arrived(sp, path));
    EXPECT_EQ(notes, "a+arrived b+arrived a.rebased b.rebased c+arrived ");
    notes.clear();
    EXPECT_EQ(policies.goes_on(path), continues);
    EXPECT_EQ(notes, continues ? "a.cell b.cell " : "a.cell b.cell a.culled b.culled ");
    notes.clear();
    policies.scattered(sp, BsdfSample{}, path);
    EXPECT_EQ(notes, "a.survived b.survived ");
  }
}

TEST(PolicyEvents, NeedNoListener) {
  Alone policies{{{}, false}, {}};
  SurfacePoint sp{};
  PathState path;
  EXPECT_TRUE(policies.arrived(sp, path));
  EXPECT_FALSE(policies.goes_on(path));
  policies.scattered(sp, BsdfSample{}, path);
}

}  // namespace
}  // namespace relume
