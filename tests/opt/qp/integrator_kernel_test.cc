#include "opt/qp/integrator_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

#include "tests/support/condensed_segment.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::LinearSegment;
using oracle::Random;

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

constexpr int kMaxWindow = 40;

// G_n and end responses from the problem in its inputs, in 80-bit arithmetic:
//     S: inputs -> profile,  E: its rows at the end,  H = S' W S
//     R = S H^-1 E' (E H^-1 E')^-1,   G = S H^-1 S' - R E H^-1 S'
struct DenseKernel {
  Matrix g;
  Matrix end_response;  // profile x order
};

DenseKernel dense_kernel(int order, const IntegratorWeights& weights, int n) {
  LinearSegment segment;
  segment.order = order;
  segment.num_steps = n;
  const int size = (order + 1) * (n + 1);
  DenseKernel kernel{Matrix::Zero(size, size), Matrix::Zero(size, order)};
  if (n < order) return kernel;
  const double weight[] = {weights.position, weights.velocity, weights.acceleration};
  Matrix s(size, n);
  Matrix w = Matrix::Zero(size, size);
  for (int i = 0; i < size; ++i) {
    const int quantity = i / (n + 1);
    const int t = i % (n + 1);
    s.row(i) = segment.map(static_cast<Quantity>(quantity), t).cast<long double>();
    w(i, i) = t < n ? weight[quantity] : 0.0;
  }
  Matrix e(order, n);
  for (int k = 0; k < order; ++k) e.row(k) = s.row(k * (n + 1) + n);
  const Matrix response = (s.transpose() * w * s).llt().solve(s.transpose());  // H^-1 S'
  const Matrix from_end = e * response;
  const Matrix end_to_end = from_end(Eigen::all, Eigen::seqN(n, order, n + 1));
  kernel.end_response = end_to_end.fullPivLu().solve(from_end).transpose();
  kernel.g = s * response - kernel.end_response * from_end;
  return kernel;
}

template <class Scalar>
Matrix table_of(const IntegratorKernel<Scalar>& kernel, int n) {
  const int size = kernel.profile_size(n);
  Matrix table(size, size);
  for (int i = 0; i < size; ++i) {
    for (int k = 0; k < size; ++k) table(k, i) = kernel.table_column(n, i)[k];
  }
  return table;
}

double relative_distance(const Matrix& a, const Matrix& b) {
  return static_cast<double>((a - b).cwiseAbs().maxCoeff() /
                             std::max(b.cwiseAbs().maxCoeff(), 1e-3L));
}

struct Case {
  int order;
  IntegratorWeights weights;
};

// Names the cases in test listings.
std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << "order_" << c.order << "_weights_" << c.weights.position << "_"
             << c.weights.velocity << "_" << c.weights.acceleration;
}

std::vector<Case> all_cases() {
  return {{1, {}},
          {1, {0.0, 3.0, 0.0}},
          {1, {0.02, 1.0, 0.0}},
          {1, {2.0, 0.5, 0.0}},
          {2, {}},
          {2, {0.0, 0.0, 1.0}},
          {2, {0.0, 5.0, 0.1}},
          {2, {0.01, 0.0, 1.0}},
          {2, {0.1, 1.0, 2.0}},
          {2, {1.0, 0.2, 4.0}}};
}

class IntegratorKernelTest : public ::testing::TestWithParam<Case> {
 protected:
  const int order_ = GetParam().order;
  const IntegratorWeights weights_ = GetParam().weights;
  InArena<IntegratorKernel<double>> storage_{order_, weights_, kMaxWindow, kMaxWindow};
  const IntegratorKernel<double>& kernel_ = *storage_;
};

template <class Scalar>
void expect_dense_kernel(const IntegratorKernel<Scalar>& kernel, const IntegratorWeights& weights,
                         double tolerance) {
  for (int n = kernel.order(); n <= kMaxWindow; ++n) {
    const DenseKernel dense = dense_kernel(kernel.order(), weights, n);
    EXPECT_LE(relative_distance(table_of(kernel, n), dense.g), tolerance) << "steps " << n;
    Matrix responses(kernel.profile_size(n), kernel.order());
    for (int i = 0; i < responses.size(); ++i) {
      responses(i) = kernel.table_end_response(n)[i];  // column major, as the profiles lie
    }
    EXPECT_LE(relative_distance(responses, dense.end_response), tolerance) << "steps " << n;
  }
}

TEST_P(IntegratorKernelTest, HasTheKernelOfTheProblemInItsInputs) {
  expect_dense_kernel(kernel_, weights_, 1e-11);
}

TEST_P(IntegratorKernelTest, HasItInSinglePrecision) {
  InArena<IntegratorKernel<float>> kernel(order_, weights_, kMaxWindow, kMaxWindow);
  expect_dense_kernel(*kernel, weights_, 1e-4);
}

TEST_P(IntegratorKernelTest, IsSymmetric) {
  for (int n = 1; n <= kMaxWindow; ++n) {
    const Matrix g = table_of(kernel_, n);
    EXPECT_LE(relative_distance(g, g.transpose()), 1e-12) << "steps " << n;
  }
}

TEST_P(IntegratorKernelTest, HasNoResponseAtFixedEnds) {
  for (int n = 1; n <= kMaxWindow; ++n) {
    const Matrix g = table_of(kernel_, n);
    for (int quantity = 0; quantity <= order_; ++quantity) {
      for (const int t : {0, n}) {
        if (quantity == order_ && t == 0) continue;  // the first input is free
        const int i = quantity * (n + 1) + t;
        EXPECT_TRUE((g.col(i).array() == 0.0L).all()) << n << " " << i;
        EXPECT_TRUE((g.row(i).array() == 0.0L).all()) << n << " " << i;
        EXPECT_EQ(kernel_.table_price(n)[i], 1.0);
      }
    }
  }
}

TEST_P(IntegratorKernelTest, HasNoResponseWhenTheEndsLeaveNoFreedom) {
  for (int n = 1; n <= order_; ++n) {
    EXPECT_TRUE((table_of(kernel_, n).array() == 0.0L).all());
    for (int i = 0; i < kernel_.profile_size(n); ++i) EXPECT_EQ(kernel_.table_price(n)[i], 1.0);
  }
}

TEST_P(IntegratorKernelTest, PricesByTheDiagonal) {
  for (int n = order_ + 1; n <= kMaxWindow; ++n) {
    for (int i = 0; i < kernel_.profile_size(n); ++i) {
      const double diagonal = kernel_.table_column(n, i)[i];
      EXPECT_GE(diagonal, 0.0);
      if (diagonal > 0.0) {
        EXPECT_NEAR(kernel_.table_price(n)[i] * std::sqrt(diagonal), 1.0, 1e-14);
      }
    }
  }
}

TEST_P(IntegratorKernelTest, ComputesWhatIsInTheTables) {
  InArena<IntegratorKernel<double>> storage(order_, weights_, kMaxWindow, 0);
  const IntegratorKernel<double>& without = *storage;
  EXPECT_EQ(without.max_table(), 0);
  for (int n = 1; n <= kMaxWindow; ++n) {
    const auto size = static_cast<std::size_t>(kernel_.profile_size(n));
    std::vector<double> response(static_cast<std::size_t>(order_) * size);
    without.compute_end_response(n, response.data());
    EXPECT_TRUE(std::equal(response.begin(), response.end(), kernel_.table_end_response(n)));
    std::vector<double> column(size);
    for (int i = 0; i < kernel_.profile_size(n); ++i) {
      without.compute_column(n, i, response.data(), column.data());
      EXPECT_TRUE(std::equal(column.begin(), column.end(), kernel_.table_column(n, i)));
    }
  }
}

TEST_P(IntegratorKernelTest, EndResponsesReachTheEnds) {
  for (int n = order_; n <= kMaxWindow; ++n) {
    const int size = kernel_.profile_size(n);
    for (int k = 0; k < order_; ++k) {
      const double* const profile = kernel_.table_end_response(n) + k * size;
      for (int quantity = 0; quantity < order_; ++quantity) {
        EXPECT_EQ(profile[quantity * (n + 1)], 0.0);
        EXPECT_NEAR(profile[quantity * (n + 1) + n], quantity == k ? 1.0 : 0.0, 1e-10);
      }
    }
  }
}

TEST_P(IntegratorKernelTest, SweepsSumColumnsAndClearTheForces) {
  constexpr int kLanes = 4;
  Random random(1);
  for (int n = order_; n <= kMaxWindow; n += 3) {
    const int size = kernel_.profile_size(n);
    Matrix force = Matrix::Zero(size, kLanes);
    std::vector<double> forces(static_cast<std::size_t>(size * kLanes));
    for (int i = 0; i < size; ++i) {
      const bool is_past_inputs = i == size - 1;
      for (int j = 0; j < kLanes && !is_past_inputs; ++j) {
        force(i, j) = forces[static_cast<std::size_t>(i * kLanes + j)] = random.uniform(-1.0, 1.0);
      }
    }
    std::vector<double> values(forces.size(), 0.0);
    kernel_.sweep<kLanes>(n, {}, kernel_.table_end_response(n), forces.data(), values.data());
    EXPECT_EQ(std::count(forces.begin(), forces.end(), 0.0), size * kLanes);
    const Matrix expected = table_of(kernel_, n) * force;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < kLanes; ++j) {
        EXPECT_NEAR(values[static_cast<std::size_t>(i * kLanes + j)],
                    static_cast<double>(expected(i, j)),
                    1e-11 * static_cast<double>(expected.cwiseAbs().maxCoeff() + 1.0L));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OrdersAndWeights, IntegratorKernelTest, ::testing::ValuesIn(all_cases()));

TEST(IntegratorKernel, HasTheClosedFormsOfASingleIntegrator) {
  InArena<IntegratorKernel<double>> storage(1, IntegratorWeights{}, kMaxWindow, kMaxWindow);
  const IntegratorKernel<double>& kernel = *storage;
  for (int n = 1; n <= kMaxWindow; ++n) {
    const double steps = n;
    for (int j = 0; j <= n; ++j) {
      const double* const position = kernel.table_column(n, j);
      for (int i = 0; i <= n; ++i) {
        EXPECT_NEAR(position[i], std::min(i, j) * (n - std::max(i, j)) / steps, 1e-13 * steps);
      }
      if (j == n) continue;
      const double* const velocity = kernel.table_column(n, n + 1 + j);
      for (int i = 0; i <= n; ++i) {
        EXPECT_NEAR(velocity[i], (j < i ? 1.0 : 0.0) - i / steps, 1e-13);
        if (i == n) continue;
        EXPECT_NEAR(velocity[n + 1 + i], (i == j ? 1.0 : 0.0) - 1.0 / steps, 1e-13);
      }
    }
    for (int i = 0; i <= n; ++i) {
      EXPECT_NEAR(kernel.table_end_response(n)[i], i / steps, 1e-14);
      if (i == n) continue;
      EXPECT_NEAR(kernel.table_end_response(n)[n + 1 + i], 1.0 / steps, 1e-14);
    }
  }
}

TEST(IntegratorKernel, ScalesWithTheInverseOfTheWeights) {
  InArena<IntegratorKernel<double>> one(2, IntegratorWeights{0.1, 1.0, 2.0}, 20, 20);
  InArena<IntegratorKernel<double>> four(2, IntegratorWeights{0.4, 4.0, 8.0}, 20, 20);
  EXPECT_LE(relative_distance(4.0L * table_of(*four, 20), table_of(*one, 20)), 1e-13);
}

TEST(IntegratorKernel, KeepsNoTablesBeyondItsWindow) {
  InArena<IntegratorKernel<double>> kernel(2, IntegratorWeights{}, 5, 60);
  EXPECT_FALSE(kernel.exhausted());
  EXPECT_EQ(kernel->max_table(), 5);
  EXPECT_EQ(kernel->max_window(), 5);
}

TEST(IntegratorKernel, SurvivesAnArenaThatIsTooSmall) {
  MemoryBlock block(1000);
  Arena arena(block);
  const IntegratorKernel<double> kernel(arena, 2, {}, 60, 60);
  EXPECT_TRUE(arena.exhausted());
}

TEST(IntegratorKernel, ComputesColumnsWithoutTheHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  InArena<IntegratorKernel<double>> kernel(2, IntegratorWeights{}, 60, 0);
  std::vector<double> response(2 * 183);
  std::vector<double> column(183);
  RtGuard guard;
  kernel->compute_end_response(60, response.data());
  kernel->compute_column(60, 90, response.data(), column.data());
  guard.stop();
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
