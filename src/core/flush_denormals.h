// A thread's floating-point mode without denormals.
#pragma once

#include <cstdint>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace relume {

/// Flushes denormals to zero during its lifetime, which Embree requires in every thread that traces. Loops of
/// core/parallel.h run their iterations in another mode. Restores the caller's mode.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(control()) { set_control(saved_ | kFlush); }
  ~FlushDenormals() { set_control(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

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
