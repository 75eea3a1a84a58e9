#include "alloc/memory_block.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

std::size_t page_B() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

// Locked memory of this process in kB, from the kernel's own account; -1 when it does not say.
long locked_kB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmLck:", 0) == 0) return std::stol(line.substr(6));
  }
  return -1;
}

long num_minor_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

TEST(MemoryBlock, IsEmptyForNoBytes) {
  const MemoryBlock block(0);
  EXPECT_EQ(block.size_B(), 0U);
  EXPECT_EQ(block.data(), nullptr);
}

TEST(MemoryBlock, RoundsUpToWholePages) {
  EXPECT_EQ(MemoryBlock(1).size_B(), page_B());
  EXPECT_EQ(MemoryBlock(page_B()).size_B(), page_B());
  EXPECT_EQ(MemoryBlock(page_B() + 1).size_B(), 2 * page_B());
}

TEST(MemoryBlock, StartsOnAPage) {
  const MemoryBlock block(100);
  ASSERT_NE(block.data(), nullptr);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.data()) % page_B(), 0U);
}

TEST(MemoryBlock, IsZeroAndWritableToItsEnd) {
  const MemoryBlock block(3 * page_B() + 5);
  for (std::size_t i = 0; i < block.size_B(); ++i) ASSERT_EQ(block.data()[i], std::byte{0});
  block.data()[0] = std::byte{1};
  block.data()[block.size_B() - 1] = std::byte{2};
  EXPECT_EQ(block.data()[block.size_B() - 1], std::byte{2});
}

TEST(MemoryBlock, SaysThatTheHostHasNoMemoryLeft) {
  for (const std::size_t size_B : {std::size_t{1} << 62, SIZE_MAX - 1, SIZE_MAX}) {
    const MemoryBlock block(size_B);
    EXPECT_EQ(block.data(), nullptr);
    EXPECT_EQ(block.size_B(), 0U);
    EXPECT_FALSE(block.locked());
  }
}

TEST(MemoryBlock, IsResidentFromTheStart) {
  const MemoryBlock block(64 * page_B());
  std::vector<unsigned char> pages(64, 0);
  ASSERT_EQ(mincore(block.data(), block.size_B(), pages.data()), 0);
  for (const unsigned char page : pages) EXPECT_EQ(page & 1, 1);
}

TEST(MemoryBlock, CausesNoPageFaultsWhenTouched) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers touch shadow pages of their own";
  const MemoryBlock block(512 * page_B());
  (void)num_minor_faults();
  const long before = num_minor_faults();
  for (std::size_t i = 0; i < block.size_B(); i += 512) block.data()[i] = std::byte{7};
  EXPECT_EQ(num_minor_faults() - before, 0);
}

TEST(MemoryBlock, IsLockedExactlyWhenItSaysSo) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers make mlock do nothing";
  const long before_kB = locked_kB();
  if (before_kB < 0) GTEST_SKIP() << "no /proc/self/status with VmLck";
  const MemoryBlock block(16 * page_B());
  const long expected_kB = block.locked() ? static_cast<long>(16 * page_B() / 1024) : 0;
  EXPECT_EQ(locked_kB() - before_kB, expected_kB);
}

TEST(MemoryBlock, UnlocksAndReleasesItsPages) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers make mlock do nothing";
  const long before_kB = locked_kB();
  if (before_kB < 0) GTEST_SKIP() << "no /proc/self/status with VmLck";
  { const MemoryBlock block(16 * page_B()); }
  EXPECT_EQ(locked_kB(), before_kB);
}

// Ends the process, because limits and privileges are given up for good: 0 when the block is usable
// without its lock, or when the host does not let go of the privilege.
[[noreturn]] void make_block_without_the_right_to_lock() {
  const rlimit none = {0, 0};
  const bool given_up =
      setrlimit(RLIMIT_MEMLOCK, &none) == 0 && (geteuid() != 0 || setuid(65534) == 0);
  if (!given_up) std::_Exit(0);
  const MemoryBlock block(4 * page_B());
  const bool usable = block.data() != nullptr && block.size_B() == 4 * page_B();
  if (usable) block.data()[block.size_B() - 1] = std::byte{1};
  std::_Exit(usable && !block.locked() ? 0 : 1);
}

TEST(MemoryBlockDeathTest, IsUsableWhenTheHostRefusesTheLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers make mlock do nothing";
  EXPECT_EXIT(make_block_without_the_right_to_lock(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace sopt
