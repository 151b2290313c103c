// A kernel of every frame. The build compiles it with fused multiply-adds, whose bits differ from the host's.
#include "frame/cuda/device_entry.h"
#include "techniques/temporal/accumulate/accumulate.h"

RELUME_KERNEL(relume::AccumulateKernel);
