#include "experiments/setup/named.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

struct Technique {
  std::string name;
  int samples = 0;
};

TEST(Named, IsTheElementItself) {
  std::vector<Technique> list{{"path", 1}, {"psf", 2}};
  named(list, "cache", "psf").samples = 3;
  EXPECT_EQ(list[1].samples, 3);
  const std::vector<Technique>& same = list;
  EXPECT_EQ(&named(same, "cache", "path"), &list[0]);
}

TEST(Named, ErrorsListTheNames) {
  const std::vector<Technique> list{{"path", 1}, {"psf", 2}};
  try {
    named(list, "cache", "vlc");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "there is no cache 'vlc'; there are path and psf");
  }
}

}  // namespace
}  // namespace relume
