// Device code of the kernels for tests.
#include "frame/cuda/device_entry.h"
#include "kernels.h"

RELUME_KERNEL(relume::cuda::testing::AddKernel);
RELUME_KERNEL(relume::cuda::testing::AppendKernel);
RELUME_KERNEL(relume::cuda::testing::CountKernel);
RELUME_KERNEL(relume::cuda::testing::PositionKernel);
RELUME_KERNEL(relume::cuda::testing::TrapKernel);
RELUME_GROUP_KERNEL(relume::cuda::testing::RowSumKernel);
