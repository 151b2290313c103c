// A thread's floating-point mode: with or without denormal numbers.
#pragma once

#include <cstdint>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace relume {

/// What arithmetic does with denormal numbers.
enum class Denormals : uint8_t {
  keep,   ///< computes with them, as IEEE 754 says and devices do
  flush,  ///< treats denormal operands and results as zero; recommended with Embree, which is then faster
};

/// Sets the mode of this thread during its lifetime, whatever the mode of its caller, which it restores. Iterations of
/// loops in core/parallel.h do not inherit the mode.
class DenormalMode {
 public:
  explicit DenormalMode(Denormals mode) : saved_(control()) {
    set_control(mode == Denormals::flush ? saved_ | kFlush : saved_ & ~kFlush);
  }
  ~DenormalMode() { set_control(saved_); }
  DenormalMode(const DenormalMode&) = delete;
  DenormalMode& operator=(const DenormalMode&) = delete;

 private:
  // The processor's floating-point control register, and its bits that flush denormal operands and results.
#if defined(__SSE__)
  static uint64_t control() { return _mm_getcsr(); }
  static void set_control(uint64_t value) { _mm_setcsr(static_cast<unsigned>(value)); }
  static constexpr uint64_t kFlush = _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON;
#elif defined(__aarch64__)
  static uint64_t control() { return __builtin_aarch64_get_fpcr64(); }
  static void set_control(uint64_t value) { __builtin_aarch64_set_fpcr64(value); }
  static constexpr uint64_t kFlush = uint64_t{1} << 24;  // FZ
#else
  static uint64_t control() { return 0; }
  static void set_control(uint64_t) {}
  static constexpr uint64_t kFlush = 0;
#endif

  uint64_t saved_;
};

}  // namespace relume
