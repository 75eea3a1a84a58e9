// Main function of a property program: `prog COUNT SEED` runs COUNT random cases. Case i draws from
// a generator seeded with SEED + i, so `prog 1 CASE_SEED` replays one case alone. Prints one
// closing line; the first failing case prints its input in full and ends the program with 1.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/oracle2.h"

namespace sopt::oracle {

// Collects what one case finds.
class CaseReport {
 public:
  // Records a check that allows `deviation` <= tolerance. NaN fails.
  void expect_within(const char* what, double deviation, double tolerance) {
    if (!(deviation <= tolerance)) {
      char text[64];
      std::snprintf(text, sizeof text, ": deviation %.3g above %.3g", deviation, tolerance);
      fail(what + std::string(text));
      return;
    }
    if (tolerance > 0.0 && deviation / tolerance > worst_share_) {
      worst_share_ = deviation / tolerance;
      worst_ = what;
    }
  }
  void expect(const char* what, bool holds) {
    if (!holds) fail(what);
  }
  void fail(const std::string& what) { failures_ += "  " + what + "\n"; }

  [[nodiscard]] bool failed() const { return !failures_.empty(); }
  [[nodiscard]] const std::string& failures() const { return failures_; }
  // Largest deviation as a share of its tolerance, and of which check.
  [[nodiscard]] double worst_share() const { return worst_share_; }
  [[nodiscard]] const std::string& worst() const { return worst_; }

 private:
  std::string failures_;
  double worst_share_ = 0.0;
  std::string worst_ = "nothing";
};

// Runs `check(Random&, CaseReport&) -> std::string`, which returns its input as text.
template <class Check>
int run_property(const char* name, int argc, char** argv, Check&& check) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s COUNT SEED\n", argv[0]);
    return 2;
  }
  const std::uint64_t count = std::strtoull(argv[1], nullptr, 10);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  CaseReport report;
  for (std::uint64_t i = 0; i < count; ++i) {
    Random random(seed + i);
    const std::string input = check(random, report);
    if (report.failed()) {
      std::printf("%s: case %llu failed\n%s  input: %s\n  replay: %s 1 %llu\n", name,
                  static_cast<unsigned long long>(i), report.failures().c_str(), input.c_str(),
                  argv[0], static_cast<unsigned long long>(seed + i));
      return 1;
    }
  }
  std::printf("%s: %llu cases passed, seed %llu, worst deviation %.3g of its tolerance (%s)\n",
              name, static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed),
              report.worst_share(), report.worst().c_str());
  return 0;
}

}  // namespace sopt::oracle
