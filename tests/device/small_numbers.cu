// Device code of a kernel for tests of denormal numbers.
#include "frame/cuda/device_entry.h"
#include "small_numbers.h"

RELUME_KERNEL(relume::testing::SmallNumbersKernel);
