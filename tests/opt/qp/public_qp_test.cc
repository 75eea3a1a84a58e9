// The public QPs with a certified optimum (Maros-Meszaros, walking robots) through DenseRows,
// judged by residuals computed apart from the solver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "tools/io/qp_file.h"
#include "tools/qp/qp_solution.h"

namespace sopt {
namespace {

class PublicQpTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder =
        std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/qp";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no public QPs in " << folder;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".qp") files_.push_back(entry.path());
    }
    std::sort(files_.begin(), files_.end());
  }

  std::vector<std::filesystem::path> files_;
};

TEST_F(PublicQpTest, AllAreThere) { EXPECT_EQ(files_.size(), 46U); }

TEST_F(PublicQpTest, AllAreSolvedToTheCertifiedOptimum) {
  double worst_difference = 0.0;
  double worst_violation = 0.0;
  double worst_distance = 0.0;  // of x, relative
  for (const std::filesystem::path& file : files_) {
    SCOPED_TRACE(file.filename());
    const QpProblem problem = load_qp(file);
    const QpSolution solution = solve_qp(problem, {});
    ASSERT_EQ(solution.result.status, QpStatus::kOptimal);
    const QpResiduals residuals = compute_residuals(problem, solution.x, solution.multipliers);
    ASSERT_TRUE(problem.optimum);
    const double difference = std::abs(residuals.objective - *problem.optimum) /
                              std::max(1.0, std::abs(*problem.optimum));
    EXPECT_LE(difference, 1e-11);
    EXPECT_LE(residuals.violation, 1e-11);
    EXPECT_LE(residuals.stationarity, 1e-14);
    EXPECT_EQ(residuals.sign, 0.0);
    EXPECT_LE(residuals.complementarity, 1e-11);
    worst_difference = std::max(worst_difference, difference);
    worst_violation = std::max(worst_violation, residuals.violation);

    ASSERT_EQ(problem.optimum_point.size(), solution.x.size());
    double distance = 0.0;
    double length = 1.0;
    for (std::size_t j = 0; j < solution.x.size(); ++j) {
      distance = std::max(distance, std::abs(solution.x[j] - problem.optimum_point[j]));
      length = std::max(length, std::abs(problem.optimum_point[j]));
    }
    EXPECT_LE(distance / length, 1e-9);
    worst_distance = std::max(worst_distance, distance / length);
  }
  std::printf("%zu public QPs: |f - f*| <= %.1e, violation <= %.1e, |x - x*| <= %.1e, relative\n",
              files_.size(), worst_difference, worst_violation, worst_distance);
}

}  // namespace
}  // namespace sopt
