#include "frame/kernel_names.h"

#include <gtest/gtest.h>

#include "frame/primitives/fill.h"

namespace relume {
namespace {

TEST(KernelNames, AreThoseOfEntries) {
  const auto element = kernel_of_entry("_ZN6relume6device3runINS_18FillElementsKernelIjEEEEvjjjj");
  ASSERT_TRUE(element);
  EXPECT_EQ(element->type, "relume::FillElementsKernel<unsigned int>");
  EXPECT_EQ(element->type, kernel_type_name<FillElementsKernel<uint32_t>>());
  EXPECT_FALSE(element->is_group);
  const auto group = kernel_of_entry("_ZN6relume6device9run_groupINS_21BlockRegressionKernelEEEvjj");
  ASSERT_TRUE(group);
  EXPECT_EQ(group->type, "relume::BlockRegressionKernel");
  EXPECT_TRUE(group->is_group);
}

TEST(KernelNames, OtherFunctionsHaveNone) {
  EXPECT_FALSE(kernel_of_entry("relume_kernel"));
  EXPECT_FALSE(kernel_of_entry("_ZN6relume5sheen6lambdaEff"));
  EXPECT_EQ(demangled("no name"), "");
}

}  // namespace
}  // namespace relume
