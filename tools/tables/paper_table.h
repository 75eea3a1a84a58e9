// The figures of [Leu22, Tables I and II], "Simulation comparison of 2D planning" and "of 5-Dof
// manipulator motion planning": means of 25 and 20 trials on a 3.7 GHz Core i9-10900K in Matlab.
// Times are of sampling and optimisation together; the deviation is of the optimisation alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace sopt {

struct PaperColumn {
  const char* label;
  int num_segments;  // to begin with
  bool merges;
  double time_s;
  double deviation_s;  // of the optimisation
  double cost;
  double iterations;
  double success_percent;
  double segments_final;
};

// Columns begin with N = 1; those that merge come last, and each has one of as many segments that
// stay.
struct PaperTable {
  const char* title;
  const char* length_unit;  // of costs
  bool is_arm;
  PaperColumn rrt_star;
  std::span<const PaperColumn> columns;

  [[nodiscard]] constexpr std::size_t num_fixed() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(columns, [](const PaperColumn& c) { return !c.merges; }));
  }
  // The column of `num_segments` that stay.
  [[nodiscard]] constexpr std::size_t i_fixed(int num_segments) const {
    return static_cast<std::size_t>(
        std::ranges::find(columns, num_segments, &PaperColumn::num_segments) - columns.begin());
  }
  // "The sOpt time can be obtained by subtracting the RRT* time from the total time."
  [[nodiscard]] constexpr double optimize_s(const PaperColumn& column) const {
    return column.time_s - rrt_star.time_s;
  }
};

inline constexpr std::array<PaperColumn, 7> kPlaneColumns = {{
    {"N = 1", 1, false, 80.32, 36.93, 31.24, 13.8, 100.0, 1.0},
    {"N = 3", 3, false, 22.32, 1.39, 31.10, 6.5, 100.0, 3.0},
    {"N = 5", 5, false, 21.63, 1.01, 30.82, 5.9, 100.0, 5.0},
    {"N = 7", 7, false, 21.43, 0.98, 31.08, 5.5, 100.0, 7.0},
    {"N = 9", 9, false, 22.01, 1.18, 30.93, 7.7, 100.0, 9.0},
    {"7, merging", 7, true, 21.42, 0.93, 31.10, 5.5, 100.0, 3.9},
    {"9, merging", 9, true, 21.81, 1.03, 31.16, 7.1, 100.0, 5.8},
}};
inline constexpr PaperTable kPlaneTable = {
    "Table I of the paper: 25 trials, Matlab, 3.7 GHz Core i9-10900K",
    "m",
    false,
    {"RRT*", 0, false, 19.82, 0.0, 37.69, 0.0, 100.0, 0.0},
    kPlaneColumns};

// Table II, above: 2 obstacles.
inline constexpr std::array<PaperColumn, 8> kArmFewColumns = {{
    {"N = 1", 1, false, 98.87, 84.23, 10.4, 6.2, 60.0, 1.0},
    {"N = 3", 3, false, 4.66, 1.29, 7.76, 5.6, 100.0, 3.0},
    {"N = 5", 5, false, 4.16, 0.90, 7.76, 6.4, 100.0, 5.0},
    {"N = 7", 7, false, 3.80, 0.93, 7.73, 7.2, 100.0, 7.0},
    {"N = 9", 9, false, 3.65, 0.76, 7.77, 6.0, 100.0, 9.0},
    {"5, merging", 5, true, 4.14, 1.06, 7.75, 6.4, 100.0, 3.6},
    {"7, merging", 7, true, 3.78, 0.76, 7.74, 6.8, 100.0, 6.2},
    {"9, merging", 9, true, 3.57, 1.10, 7.77, 6.0, 100.0, 8.4},
}};
inline constexpr PaperTable kArmFewTable = {
    "Table II of the paper, 2 obstacles: 20 trials, Matlab, 3.7 GHz Core i9-10900K",
    "rad",
    true,
    {"RRT*", 0, false, 1.49, 0.0, 8.40, 0.0, 100.0, 0.0},
    kArmFewColumns};

// Below: 7 to 9 obstacles.
inline constexpr std::array<PaperColumn, 8> kArmManyColumns = {{
    {"N = 1", 1, false, 170.61, 48.51, 7.80, 6.4, 10.0, 1.0},
    {"N = 3", 3, false, 28.42, 2.23, 7.86, 6.0, 100.0, 3.0},
    {"N = 5", 5, false, 27.48, 1.04, 7.57, 7.9, 100.0, 5.0},
    {"N = 7", 7, false, 26.56, 0.56, 7.58, 7.3, 100.0, 7.0},
    {"N = 9", 9, false, 26.11, 0.12, 7.53, 7.6, 100.0, 9.0},
    {"5, merging", 5, true, 25.77, 0.59, 7.69, 6.3, 100.0, 3.0},
    {"7, merging", 7, true, 25.76, 0.10, 7.66, 7.0, 100.0, 4.7},
    {"9, merging", 9, true, 25.79, 1.00, 7.63, 7.2, 100.0, 6.3},
}};
inline constexpr PaperTable kArmManyTable = {
    "Table II of the paper, 7 to 9 obstacles: 20 trials, Matlab, 3.7 GHz Core i9-10900K",
    "rad",
    true,
    {"RRT*", 0, false, 23.26, 0.0, 9.35, 0.0, 100.0, 0.0},
    kArmManyColumns};

}  // namespace sopt
