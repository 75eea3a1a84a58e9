// Counts what a program that links this file takes from the heap with operator new, per thread.
// The libraries call nothing else that allocates: ctest checks their symbols.
#pragma once

#include <cstdint>

namespace sopt {

// Of the calling thread, since it began.
[[nodiscard]] std::int64_t num_allocations() noexcept;

}  // namespace sopt
