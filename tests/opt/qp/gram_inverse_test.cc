#include "opt/qp/gram_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/planted_qp.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

template <class Scalar>
class GramInverseTest : public ::testing::Test {
 protected:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  static constexpr int kMaxRows = 40;
  // Of solutions, for a condition of 100.
  static constexpr double kTol = 2e3 * std::numeric_limits<Scalar>::epsilon();

  // Loads the column of index i of `k_`.
  void load_column(int i) {
    for (int j = 0; j < gram_->size(); ++j) gram_->column()[j] = k_(indices_[at(j)], i);
  }
  // Index i enters.
  void append(int i) {
    load_column(i);
    const Scalar curvature = gram_->solve_column(0, k_(i, i));
    ASSERT_GT(curvature, Scalar(0));
    ASSERT_TRUE(gram_->try_append(curvature));
    indices_.push_back(i);
  }
  void remove(int position) {
    gram_->remove(position);
    indices_.erase(indices_.begin() + position);
  }
  [[nodiscard]] Eigen::MatrixXd expected() const {
    const auto q = static_cast<Eigen::Index>(indices_.size());
    Eigen::MatrixXd k(q, q);
    for (int i = 0; i < q; ++i) {
      for (int j = 0; j < q; ++j)
        k(i, j) = static_cast<double>(k_(indices_[at(i)], indices_[at(j)]));
    }
    return k;
  }
  void expect_factor(Random& random) {
    ASSERT_EQ(gram_->size(), static_cast<int>(indices_.size()));
    const int q = gram_->size();
    const Vector b = Vector::NullaryExpr(q, [&] { return Scalar(random.uniform(-1.0, 1.0)); });
    const Eigen::LLT<Eigen::MatrixXd> llt(expected());
    const Eigen::VectorXd& exact = b.template cast<double>();
    const auto expect_near = [](const Vector& x, const Eigen::VectorXd& wanted) {
      EXPECT_LE((x.template cast<double>() - wanted).norm(), kTol * (1.0 + wanted.norm()));
    };
    Vector x = b;
    gram_->solve(x.data());
    expect_near(x, llt.solve(exact));
    std::copy(b.data(), b.data() + q, gram_->column());
    const Scalar curvature = gram_->solve_column(0, Scalar(100));
    expect_near(Eigen::Map<const Vector>(gram_->direction(), q), llt.solve(exact));
    EXPECT_NEAR(curvature, 100.0 - exact.dot(llt.solve(exact)), kTol * 200.0);
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  Matrix k_;
  std::vector<int> indices_;
  InArena<GramInverse<Scalar>> gram_{kMaxRows};
};

using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(GramInverseTest, Scalars);

TYPED_TEST(GramInverseTest, IsEmptyAtFirst) {
  EXPECT_EQ(this->gram_->size(), 0);
  EXPECT_EQ(this->gram_->solve_column(0, TypeParam(3)), TypeParam(3));
}

TYPED_TEST(GramInverseTest, FollowsRandomChanges) {
  Random random(1);
  for (int round = 0; round < 30; ++round) {
    const int n = 1 + random.index(this->kMaxRows);
    this->k_ = oracle::random_hessian(random, n, 100.0, 0.1).template cast<TypeParam>();
    this->gram_->clear();
    this->indices_.clear();
    for (int change = 0; change < 150; ++change) {
      const int q = this->gram_->size();
      const int i = random.index(n);
      const bool is_in =
          std::find(this->indices_.begin(), this->indices_.end(), i) != this->indices_.end();
      if (!is_in && !random.chance(0.3)) {
        this->append(i);
      } else if (q > 0) {
        this->remove(random.index(q));
      }
      if (change % 5 == 0) this->expect_factor(random);
      if (this->HasFatalFailure()) return;
    }
  }
}

TYPED_TEST(GramInverseTest, RemovesFirstMiddleLastAndOnly) {
  Random random(2);
  this->k_ = oracle::random_hessian(random, 5, 100.0, 0.1).template cast<TypeParam>();
  for (int i = 0; i < 5; ++i) this->append(i);
  for (const int position : {0, 2, 2, 0, 0}) {
    this->remove(position);
    this->expect_factor(random);
  }
  EXPECT_EQ(this->gram_->size(), 0);
}

TYPED_TEST(GramInverseTest, ReusesTheForwardSolveBeforeAChange) {
  Random random(3);
  this->k_ = oracle::random_hessian(random, 12, 100.0, 0.1).template cast<TypeParam>();
  for (int i = 0; i < 11; ++i) this->append(i);
  const TypeParam diagonal = this->k_(11, 11);
  this->load_column(11);
  (void)this->gram_->solve_column(0, diagonal);
  for (const int position : {7, 3, 8, 0}) {
    this->remove(position);
    const TypeParam reused = this->gram_->solve_column(position, diagonal);
    const std::vector<TypeParam> direction(this->gram_->direction(),
                                           this->gram_->direction() + this->gram_->size());
    this->load_column(11);
    EXPECT_NEAR(reused, this->gram_->solve_column(0, diagonal), this->kTol);
    for (int j = 0; j < this->gram_->size(); ++j) {
      EXPECT_NEAR(direction[this->at(j)], this->gram_->direction()[j], this->kTol * 100.0);
    }
  }
}

TYPED_TEST(GramInverseTest, TellsTheCurvatureOfADependentRow) {
  Random random(5);
  this->k_ = oracle::random_hessian(random, 6, 10.0, 1.0).template cast<TypeParam>();
  for (int i = 0; i < 6; ++i) this->append(i);
  this->load_column(2);
  EXPECT_NEAR(this->gram_->solve_column(0, this->k_(2, 2)), 0.0, this->kTol);
  for (int j = 0; j < 6; ++j) {
    EXPECT_NEAR(this->gram_->direction()[j], j == 2 ? 1.0 : 0.0, this->kTol);
  }
}

TYPED_TEST(GramInverseTest, RefusesRowsBeyondItsCapacity) {
  InArena<GramInverse<TypeParam>> gram(2);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) gram->column()[j] = TypeParam(0);
    EXPECT_EQ(gram->try_append(gram->solve_column(0, TypeParam(4))), i < 2);
  }
  EXPECT_EQ(gram->size(), 2);
  TypeParam x[] = {4, 8};
  gram->solve(x);
  EXPECT_EQ(x[0], TypeParam(1));
  EXPECT_EQ(x[1], TypeParam(2));
}

TYPED_TEST(GramInverseTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  TypeParam x[] = {1, 1};
  RtGuard guard;
  (void)this->gram_->try_append(this->gram_->solve_column(0, TypeParam(1)));
  this->gram_->column()[0] = TypeParam(0.5);
  (void)this->gram_->try_append(this->gram_->solve_column(0, TypeParam(1)));
  this->gram_->solve(x);
  this->gram_->remove(0);
  guard.stop();
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
