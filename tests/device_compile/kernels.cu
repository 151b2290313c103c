// Compiles all headers with kernels, and every pass and group kernel, with nvcc. Each technique, the primitives and the
// scene list their kernels in kernels.inc; the build collects these lists in all_kernels.inc.
#include "core/fixed_point.h"
#include "core/frame.h"
#include "core/hash.h"
#include "core/hd.h"
#include "core/lanes.h"
#include "core/octahedral.h"
#include "core/ray.h"
#include "core/vec.h"
#include "core/view.h"
#include "frame/group.h"
#include "framebuffer/tone_map.h"
#include "relume/error.h"

namespace relume::device {

/// Instantiates a pass kernel's operator for nvcc; never launched.
template <typename Kernel>
__global__ void run(Kernel kernel, uint32_t width, uint32_t height) {
  const uint32_t x = blockIdx.x * blockDim.x + threadIdx.x;
  const uint32_t y = blockIdx.y * blockDim.y + threadIdx.y;
  if (x < width && y < height) kernel(x, y);
}

/// The same for a group kernel: one block of threads per element.
template <typename Kernel>
__global__ void __launch_bounds__(Kernel::kThreads) run_group(Kernel kernel) {
  __shared__ typename Kernel::Shared shared;
  kernel(ThreadGroup<Kernel::kThreads>{}, shared, blockIdx.x, blockIdx.y);
}

/// Calls the functions that src/core provides for kernels.
struct CoreKernel {
  View<FixedPointRgb> sums;
  View<uint32_t> counts;
  View<uint32_t> directions;
  View<const Mat4> matrices;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = hash(x, y, 0u, 1u) % directions.size;
    const Vec3 n = unpack_direction(directions[i]);
    const Frame frame = make_frame(n);
    const Vec3 w = frame.to_world(frame.to_local(transform_vector(matrices[0], n)));
    const Vec3 p = transform_point(matrices[0], {static_cast<float>(x), static_cast<float>(y), to_unit_float(i)});
    const Ray ray{offset_origin(p, max_component(abs(p)) * gamma_bound(3), n, w), w, kInfinity};
    const Rgb value = exp(-ray.origin) * lerp(0.0f, safe_sqrt(max_component(w)), saturate(min_component(w)));
    if (is_finite(value) && !is_black(value)) sums[i].add(value * luminance(sums[i].value()));
    atomic_add(&counts[i], float_bits(length_squared(w)) ^ (Hit{}.valid() ? 1u : 0u));
    directions[i] = pack_direction(glm::normalize(w));
  }
};

}  // namespace relume::device

/// Compiles a kernel of the given type.
#define RELUME_KERNEL(...) template __global__ void relume::device::run(__VA_ARGS__, uint32_t, uint32_t)

/// The same for a group kernel.
#define RELUME_GROUP_KERNEL(...) template __global__ void relume::device::run_group(__VA_ARGS__)

RELUME_KERNEL(relume::device::CoreKernel);

#include "all_kernels.inc"
