#include "opt/qp/cholesky_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "tests/support/planted_qp.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

template <class Scalar>
class CholeskyFactorTest : public ::testing::Test {
 protected:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  static constexpr int kMaxSize = 40;
  // Of solutions, for a condition of 100.
  static constexpr double kTol = 2e3 * std::numeric_limits<Scalar>::epsilon();

  [[nodiscard]] bool factorizes(const Eigen::MatrixXd& h) {
    const Matrix m = h.template cast<Scalar>();
    const bool is_accepted = factor_->factorize(static_cast<int>(m.rows()), m.data());
    EXPECT_EQ(factor_->size(), is_accepted ? m.rows() : 0);
    return is_accepted;
  }
  // Vectors solved for are padded.
  [[nodiscard]] static Vector padded_vector(const Vector& x) {
    Vector result = Vector::Zero(padded<Scalar>(static_cast<int>(x.size())));
    result.head(x.size()) = x;
    return result;
  }
  static void expect_near(const Vector& x, const Eigen::VectorXd& expected) {
    EXPECT_LE((x.head(expected.size()).template cast<double>() - expected).norm(),
              kTol * (1.0 + expected.norm()));
  }

  InArena<CholeskyFactor<Scalar>> factor_{kMaxSize};
};

using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(CholeskyFactorTest, Scalars);

TYPED_TEST(CholeskyFactorTest, SolvesAsEigenDoes) {
  using Values = typename TestFixture::Vector;
  Random random(1);
  for (int n = 1; n <= this->kMaxSize; ++n) {
    const Eigen::MatrixXd h = oracle::random_hessian(random, n, 100.0, 0.1)
                                  .template cast<TypeParam>()
                                  .template cast<double>();
    ASSERT_TRUE(this->factorizes(h));
    const Eigen::LLT<Eigen::MatrixXd> llt(h);
    // Leading zeros are not looked at.
    const int first = random.index(n + 1);
    Values b = Values::Zero(n);
    for (int i = first; i < n; ++i) b[i] = static_cast<TypeParam>(random.uniform(-1.0, 1.0));
    const Eigen::VectorXd exact = b.template cast<double>();
    Values x = this->padded_vector(b);
    this->factor_->solve_lower(x.data(), first);
    this->expect_near(x, llt.matrixL().solve(exact));
    x = this->padded_vector(b);
    this->factor_->solve_upper(x.data());
    this->expect_near(x, llt.matrixU().solve(exact));
  }
}

TYPED_TEST(CholeskyFactorTest, ReadsTheLowerTriangleOnly) {
  const TypeParam h[] = {4, std::numeric_limits<TypeParam>::quiet_NaN(), 2, 5};
  ASSERT_TRUE(this->factor_->factorize(2, h));
  TypeParam x[padded<TypeParam>(2)] = {4, 6};
  this->factor_->solve_lower(x, 0);
  EXPECT_EQ(x[0], TypeParam(2));
  EXPECT_EQ(x[1], TypeParam(2));
}

TYPED_TEST(CholeskyFactorTest, RefusesWhatIsNotPositiveDefinite) {
  Random random(2);
  const Eigen::MatrixXd h = oracle::random_hessian(random, 9, 100.0, 0.1);
  EXPECT_TRUE(this->factorizes(h));
  EXPECT_FALSE(this->factorizes(-h));
  EXPECT_FALSE(this->factorizes(Eigen::MatrixXd::Zero(1, 1)));
  EXPECT_FALSE(this->factorizes(Eigen::MatrixXd::Ones(4, 4)));
  EXPECT_FALSE(this->factorizes(h - 0.2 * Eigen::MatrixXd::Identity(9, 9)));
  for (int i = 0; i < 9; ++i) {
    Eigen::MatrixXd wrong = h;
    wrong.row(i).setZero();
    wrong.col(i).setZero();
    EXPECT_FALSE(this->factorizes(wrong)) << i;
  }
}

TYPED_TEST(CholeskyFactorTest, RefusesWhatIsNotFinite) {
  Random random(3);
  const Eigen::MatrixXd h = oracle::random_hessian(random, 9, 100.0, 0.1);
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), kInf, -kInf}) {
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j) {
        Eigen::MatrixXd wrong = h;
        wrong(i, j) = bad;
        EXPECT_FALSE(this->factorizes(wrong)) << i << " " << j << " " << bad;
      }
    }
  }
}

TYPED_TEST(CholeskyFactorTest, HoldsItsCapacityAndNoMore) {
  EXPECT_TRUE(this->factorizes(Eigen::MatrixXd::Identity(this->kMaxSize, this->kMaxSize)));
  EXPECT_FALSE(this->factorizes(Eigen::MatrixXd::Identity(this->kMaxSize + 1, this->kMaxSize + 1)));
  EXPECT_FALSE(this->factor_->factorize(-1, nullptr));
  EXPECT_TRUE(this->factor_->factorize(0, nullptr));
}

TYPED_TEST(CholeskyFactorTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const TypeParam h[] = {4, 2, 2, 5};
  TypeParam x[padded<TypeParam>(2)] = {1, 1};
  RtGuard guard;
  const bool is_accepted = this->factor_->factorize(2, h);
  this->factor_->solve_lower(x, 0);
  this->factor_->solve_upper(x);
  guard.stop();
  EXPECT_TRUE(is_accepted);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
