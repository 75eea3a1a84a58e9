// One contiguous block from mmap, pre-faulted and locked into RAM, so that touching it later never
// enters the kernel. Setup only. A host that refuses the lock (RLIMIT_MEMLOCK) leaves a usable,
// pre-faulted block with `locked() == false`: reported, never fatal.
#pragma once

#include <cstddef>

namespace sopt {

class MemoryBlock {
 public:
  // size_B is rounded up to whole pages; 0 gives an empty block. When the host has no memory left
  // `data()` is null and `size_B()` is 0.
  explicit MemoryBlock(std::size_t size_B) noexcept;
  ~MemoryBlock();
  MemoryBlock(const MemoryBlock&) = delete;
  MemoryBlock& operator=(const MemoryBlock&) = delete;

  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size_B() const noexcept { return size_B_; }
  [[nodiscard]] bool locked() const noexcept { return locked_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_B_ = 0;
  bool locked_ = false;
};

}  // namespace sopt
