// Sets flush-to-zero and denormals-are-zero for a scope and restores what was there. A denormal
// operand can make one multiplication take over a hundred cycles, which shows up only in the tail.
#pragma once

#include <cstdint>

namespace sopt {

class ScopedFlushDenormals {
 public:
  ScopedFlushDenormals() noexcept;
  ~ScopedFlushDenormals();
  ScopedFlushDenormals(const ScopedFlushDenormals&) = delete;
  ScopedFlushDenormals& operator=(const ScopedFlushDenormals&) = delete;

 private:
  std::uint64_t saved_;
};

}  // namespace sopt
