#include "rt/float_env.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace sopt {
namespace {

#if defined(__x86_64__)
constexpr std::uint64_t kFlushBits = 0x8040;  // MXCSR: FTZ is bit 15, DAZ bit 6
std::uint64_t read_control() noexcept { return _mm_getcsr(); }
void write_control(std::uint64_t value) noexcept { _mm_setcsr(static_cast<unsigned>(value)); }
#elif defined(__aarch64__)
constexpr std::uint64_t kFlushBits = 1ULL << 24;  // FPCR.FZ
std::uint64_t read_control() noexcept {
  std::uint64_t value = 0;
  asm volatile("mrs %0, fpcr" : "=r"(value));
  return value;
}
void write_control(std::uint64_t value) noexcept { asm volatile("msr fpcr, %0" : : "r"(value)); }
#else
constexpr std::uint64_t kFlushBits = 0;
std::uint64_t read_control() noexcept { return 0; }
void write_control(std::uint64_t /*value*/) noexcept {}
#endif

}  // namespace

ScopedFlushDenormals::ScopedFlushDenormals() noexcept : saved_(read_control()) {
  write_control(saved_ | kFlushBits);
}

ScopedFlushDenormals::~ScopedFlushDenormals() { write_control(saved_); }

}  // namespace sopt
