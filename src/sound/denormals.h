// Sets flush-to-zero and denormals-are-zero for the current thread (RAII): resonators would otherwise decay
// into denormals and cost sixty times more. A no-op on processors other than x86-64 and arm64.
#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace intaglio::sound {

class DenormalsAreZero {
 public:
#if defined(__SSE2__)
  DenormalsAreZero() : saved_(_mm_getcsr()) {
    _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
  }
  ~DenormalsAreZero() {
    _mm_setcsr(saved_);
  }
#elif defined(__aarch64__)
  DenormalsAreZero() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    asm volatile("msr fpcr, %0" ::"r"(saved_ | (std::uint64_t{1} << 24)));
  }
  ~DenormalsAreZero() {
    asm volatile("msr fpcr, %0" ::"r"(saved_));
  }
#else
  DenormalsAreZero() = default;
#endif
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
  unsigned saved_;
#elif defined(__aarch64__)
  std::uint64_t saved_;
#endif
};

}  // namespace intaglio::sound
