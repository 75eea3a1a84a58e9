// A vector whose capacity is fixed when it is taken from an arena. Growing beyond it is refused and
// says so; nothing is ever moved or released, so references stay valid. Elements have no
// destructor. Copying the vector is not possible: there is one owner of the storage.
#pragma once

#include <algorithm>
#include <cassert>
#include <span>
#include <type_traits>
#include <utility>

#include "alloc/arena.h"
#include "rt/annotations.h"

namespace sopt {

template <class T>
class FixedVector {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  FixedVector() noexcept = default;
  // A capacity below 1, or an arena that is exhausted or measures, gives a vector that holds
  // nothing.
  FixedVector(Arena& arena, int capacity) noexcept
      : data_(arena.take<T>(static_cast<std::size_t>(std::max(capacity, 0)))),
        capacity_(data_ == nullptr ? 0 : capacity) {}
  FixedVector(const FixedVector&) = delete;
  FixedVector& operator=(const FixedVector&) = delete;
  // The moved-from vector holds nothing and has no capacity.
  FixedVector(FixedVector&& other) noexcept { swap(other); }
  FixedVector& operator=(FixedVector&& other) noexcept {
    FixedVector moved(static_cast<FixedVector&&>(other));
    swap(moved);
    return *this;
  }

  [[nodiscard]] int size() const SOPT_RT { return size_; }
  [[nodiscard]] int capacity() const SOPT_RT { return capacity_; }
  [[nodiscard]] bool empty() const SOPT_RT { return size_ == 0; }

  [[nodiscard]] T& operator[](int i) SOPT_RT {
    assert(i >= 0 && i < size_);
    return data_[i];
  }
  [[nodiscard]] const T& operator[](int i) const SOPT_RT {
    assert(i >= 0 && i < size_);
    return data_[i];
  }
  [[nodiscard]] T& back() SOPT_RT { return (*this)[size_ - 1]; }
  [[nodiscard]] const T& back() const SOPT_RT { return (*this)[size_ - 1]; }
  [[nodiscard]] T* begin() SOPT_RT { return data_; }
  [[nodiscard]] T* end() SOPT_RT { return data_ + size_; }
  [[nodiscard]] const T* begin() const SOPT_RT { return data_; }
  [[nodiscard]] const T* end() const SOPT_RT { return data_ + size_; }
  [[nodiscard]] std::span<const T> span() const SOPT_RT {
    return {data_, static_cast<std::size_t>(size_)};
  }

  void clear() SOPT_RT { size_ = 0; }

  // False, and nothing changes, when the vector is full.
  [[nodiscard]] bool try_push_back(const T& value) SOPT_RT {
    if (size_ >= capacity_) return false;
    data_[size_++] = value;
    return true;
  }

  // New elements keep what the storage held. False, and nothing changes, beyond the capacity.
  [[nodiscard]] bool try_resize(int size) SOPT_RT {
    if (size < 0 || size > capacity_) return false;
    size_ = size;
    return true;
  }

  // Copies `other`; false, and nothing changes, when it does not fit.
  [[nodiscard]] bool try_assign(std::span<const T> other) SOPT_RT {
    if (other.size() > static_cast<std::size_t>(capacity_)) return false;
    std::copy(other.begin(), other.end(), data_);
    size_ = static_cast<int>(other.size());
    return true;
  }

 private:
  void swap(FixedVector& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(size_, other.size_);
  }

  T* data_ = nullptr;
  int capacity_ = 0;
  int size_ = 0;
};

}  // namespace sopt
