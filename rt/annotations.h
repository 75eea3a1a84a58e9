// Marks functions that may be called after start-up from a real-time thread: they do not throw, do
// not touch the heap, take no lock and have no unbounded loop. Setup functions take an `Arena&`
// instead; no function has both. Compilers that know function effects check the mark.
#pragma once

#if defined(__clang__) && defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define SOPT_RT noexcept [[clang::nonblocking]]
#endif
#endif

#ifndef SOPT_RT
#define SOPT_RT noexcept
#endif
