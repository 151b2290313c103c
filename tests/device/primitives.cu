// Device code of kernels that only the tests of primitives launch.
#include "frame/cuda/device_entry.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/reduce.h"

RELUME_KERNEL(relume::ReduceKernel<relume::Elements<float>, relume::Sum<float>>);
RELUME_KERNEL(relume::ReduceKernel<relume::Elements<float>, relume::Min<float>>);
RELUME_KERNEL(relume::ReduceKernel<relume::Elements<float>, relume::Max<float>>);
RELUME_KERNEL(relume::ReduceKernel<relume::Elements<uint32_t>, relume::Min<uint32_t>>);
RELUME_KERNEL(relume::AnyKernel<relume::Elements<uint32_t>>);
RELUME_KERNEL(relume::TakeElementsKernel<uint32_t>);
