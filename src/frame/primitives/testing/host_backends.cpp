// Both forms of kernels on the host, and several numbers of threads.
#include <gtest/gtest.h>

#include <string>

#include "frame/primitives/testing/backends.h"

namespace relume::testing {

void for_each_backend(const std::function<void(const PrimitiveLaunch&)>& test) {
  PrimitiveScratch scratch;  // the memory of earlier calls
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    for (const int threads : {1, 2, 5}) {
      SCOPED_TRACE((form == KernelForm::host ? "host form, threads: " : "device form, threads: ") +
                   std::to_string(threads));
      Backend backend(threads, form);
      test(PrimitiveLaunch{backend, "test", scratch});
    }
  }
}

}  // namespace relume::testing
