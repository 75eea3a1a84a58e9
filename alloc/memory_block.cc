#include "alloc/memory_block.h"

#include <sys/mman.h>
#include <unistd.h>

#include <limits>

namespace sopt {

MemoryBlock::MemoryBlock(std::size_t size_B) noexcept {
  const auto page_B = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  if (size_B == 0 || size_B > std::numeric_limits<std::size_t>::max() - page_B) return;
  const std::size_t rounded_B = (size_B + page_B - 1) / page_B * page_B;
  void* const mapped = mmap(nullptr, rounded_B, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (mapped == MAP_FAILED) return;
  data_ = static_cast<std::byte*>(mapped);
  size_B_ = rounded_B;
  locked_ = mlock(data_, size_B_) == 0;
  // MAP_POPULATE is best effort: a write to every page makes sure each one is there.
  for (std::size_t at_B = 0; at_B < size_B_; at_B += page_B) {
    static_cast<volatile std::byte*>(data_)[at_B] = std::byte{0};
  }
}

MemoryBlock::~MemoryBlock() {
  if (data_ != nullptr) munmap(data_, size_B_);
}

}  // namespace sopt
