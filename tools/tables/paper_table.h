// The figures of [Leu22, Table I], "Simulation comparison of 2D planning": means of 25 trials on a
// 3.7 GHz Core i9-10900K in Matlab. Times are of sampling and optimisation together; the deviation
// is of the optimisation alone.
#pragma once

#include <array>
#include <cstddef>

namespace sopt {

struct PaperColumn {
  const char* label;
  double time_s;
  double deviation_s;  // of the optimisation
  double cost;
  double iterations;
  double success_percent;
  double segments_final;
};

inline constexpr PaperColumn kPaperRrtStar = {"RRT*", 19.82, 0.0, 37.69, 0.0, 100.0, 0.0};

inline constexpr std::size_t kNumTableColumns = 7;
inline constexpr std::array<PaperColumn, kNumTableColumns> kPaperColumns = {{
    {"N = 1", 80.32, 36.93, 31.24, 13.8, 100.0, 1.0},
    {"N = 3", 22.32, 1.39, 31.10, 6.5, 100.0, 3.0},
    {"N = 5", 21.63, 1.01, 30.82, 5.9, 100.0, 5.0},
    {"N = 7", 21.43, 0.98, 31.08, 5.5, 100.0, 7.0},
    {"N = 9", 22.01, 1.18, 30.93, 7.7, 100.0, 9.0},
    {"7, merging", 21.42, 0.93, 31.10, 5.5, 100.0, 3.9},
    {"9, merging", 21.81, 1.03, 31.16, 7.1, 100.0, 5.8},
}};

// "The sOpt time can be obtained by subtracting the RRT* time from the total time."
[[nodiscard]] constexpr double paper_optimize_s(const PaperColumn& column) {
  return column.time_s - kPaperRrtStar.time_s;
}

}  // namespace sopt
