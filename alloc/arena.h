// Bump allocator over a borrowed block: objects are taken once at setup and live as long as the
// block. There is no release. An arena without a block only measures: the same constructor that
// takes memory from a real arena tells, on a measuring one, how many bytes it needs, so
// `required_bytes` can never disagree with what is taken.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>

#include "alloc/memory_block.h"

namespace sopt {

class Arena {
 public:
  // Cache line: two workers never share one because of neighbouring `take`s.
  static constexpr std::size_t kAlignment = 64;

  explicit Arena(const MemoryBlock& block) noexcept
      : begin_(block.data()), size_B_(block.size_B()) {}

  // Takes nothing and hands out null; `used_B()` says what a real arena would need.
  [[nodiscard]] static Arena measuring() noexcept {
    Arena arena;
    arena.measuring_ = true;
    return arena;
  }
  [[nodiscard]] bool is_measuring() const noexcept { return measuring_; }

  // Room for `count` value-initialised objects. Null when measuring, when count is 0, and when the
  // block is exhausted, which also sets `exhausted()` for good.
  template <class T>
  [[nodiscard]] T* take(std::size_t count) noexcept {
    static_assert(std::is_trivially_destructible_v<T>, "an arena never runs destructors");
    static_assert(alignof(T) <= kAlignment);
    std::byte* const storage = take_bytes(count, sizeof(T));
    if (storage == nullptr || count == 0) return nullptr;
    T* const first = reinterpret_cast<T*>(storage);
    std::uninitialized_value_construct_n(first, count);
    return first;
  }

  [[nodiscard]] std::size_t used_B() const noexcept { return used_B_; }
  [[nodiscard]] bool exhausted() const noexcept { return exhausted_; }

 private:
  Arena() noexcept = default;

  [[nodiscard]] std::byte* take_bytes(std::size_t count, std::size_t size_B) noexcept {
    if (count > (std::numeric_limits<std::size_t>::max() - kAlignment) / size_B) {
      exhausted_ = true;
      return nullptr;
    }
    const std::size_t wanted_B = (count * size_B + kAlignment - 1) / kAlignment * kAlignment;
    if (!measuring_ && (exhausted_ || wanted_B > size_B_ - used_B_)) {
      exhausted_ = true;
      return nullptr;
    }
    std::byte* const first = measuring_ ? nullptr : begin_ + used_B_;
    used_B_ += wanted_B;
    return first;
  }

  std::byte* begin_ = nullptr;
  std::size_t size_B_ = 0;
  std::size_t used_B_ = 0;
  bool exhausted_ = false;
  bool measuring_ = false;
};

}  // namespace sopt
