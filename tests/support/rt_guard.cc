#include "tests/support/rt_guard.h"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SOPT_RT_GUARD 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define SOPT_RT_GUARD 0
#endif
#endif
#if !defined(SOPT_RT_GUARD)
#if defined(__GLIBC__)
#define SOPT_RT_GUARD 1
#else
#define SOPT_RT_GUARD 0
#endif
#endif

namespace {

constinit thread_local sopt::RtCounts t_counts;  // constant-initialised: reading it never allocates

}  // namespace

#if SOPT_RT_GUARD

#include <dlfcn.h>
#include <pthread.h>

namespace {

using LockFunction = int (*)(pthread_mutex_t*);

// Resolved before main; the dynamic linker itself never comes through the interposed name.
LockFunction g_lock = nullptr;

__attribute__((constructor)) void resolve_lock() noexcept {
  g_lock = reinterpret_cast<LockFunction>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
}

}  // namespace

extern "C" {

// The C library's own names for what is forwarded to.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t size_B);
void __libc_free(void* memory);
void* __libc_calloc(std::size_t count, std::size_t size_B);
void* __libc_realloc(void* memory, std::size_t size_B);
void* __libc_memalign(std::size_t alignment_B, std::size_t size_B);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size_B) noexcept {
  ++t_counts.num_allocations;
  return __libc_malloc(size_B);
}

void free(void* memory) noexcept {
  if (memory != nullptr) ++t_counts.num_releases;
  __libc_free(memory);
}

void* calloc(std::size_t count, std::size_t size_B) noexcept {
  ++t_counts.num_allocations;
  return __libc_calloc(count, size_B);
}

void* realloc(void* memory, std::size_t size_B) noexcept {
  ++t_counts.num_allocations;
  return __libc_realloc(memory, size_B);
}

void* memalign(std::size_t alignment_B, std::size_t size_B) noexcept {
  ++t_counts.num_allocations;
  return __libc_memalign(alignment_B, size_B);
}

void* aligned_alloc(std::size_t alignment_B, std::size_t size_B) noexcept {
  ++t_counts.num_allocations;
  return __libc_memalign(alignment_B, size_B);
}

int posix_memalign(void** memory, std::size_t alignment_B, std::size_t size_B) noexcept {
  const bool is_power_of_two = alignment_B != 0 && (alignment_B & (alignment_B - 1)) == 0;
  if (!is_power_of_two || alignment_B % sizeof(void*) != 0) return EINVAL;
  ++t_counts.num_allocations;
  void* const taken = __libc_memalign(alignment_B, size_B);
  if (taken == nullptr) return ENOMEM;
  *memory = taken;
  return 0;
}

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  ++t_counts.num_locks;
  if (g_lock == nullptr) resolve_lock();
  return g_lock(mutex);
}

}  // extern "C"

#endif  // SOPT_RT_GUARD

namespace sopt {

bool RtGuard::available() noexcept { return SOPT_RT_GUARD != 0; }

RtGuard::RtGuard() noexcept : at_start_(t_counts) {}

void RtGuard::stop() noexcept {
  at_end_ = end();
  is_stopped_ = true;
}

RtCounts RtGuard::end() const noexcept { return is_stopped_ ? at_end_ : t_counts; }

std::int64_t RtGuard::num_allocations() const noexcept {
  return end().num_allocations - at_start_.num_allocations;
}

std::int64_t RtGuard::num_releases() const noexcept {
  return end().num_releases - at_start_.num_releases;
}

std::int64_t RtGuard::num_locks() const noexcept { return end().num_locks - at_start_.num_locks; }

}  // namespace sopt
