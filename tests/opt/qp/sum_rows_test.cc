#include "opt/qp/sum_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "tests/support/condensed_segment.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

using Arm = KernelRows<double, 4>;
using Sum = SumRows<DenseRows<double>, Arm>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct CoupledRow {
  Eigen::VectorXd base;  // of the base's variables
  int t = 1;
  Eigen::VectorXd arm;  // of the joints' positions
  double bound = 0.0;
};

// A base of dense cost, equalities and bounds, an arm as a linear segment, rows on both.
struct MobileQp {
  RowMatrix base_hessian;
  Eigen::VectorXd base_gradient;
  RowMatrix base_equalities;
  Eigen::VectorXd base_target, base_lower, base_upper;
  LinearSegment arm;
  std::vector<CoupledRow> coupled;

  [[nodiscard]] int num_base() const { return static_cast<int>(base_gradient.size()); }
};

// Everything holds at a random point, coupled rows by at least `slack`.
MobileQp random_mobile_qp(Random& random, double slack) {
  MobileQp qp;
  const int n = 3 + random.index(10);
  const auto draw = [&](int size, double scale) {
    Eigen::VectorXd v(size);
    for (double& x : v) x = random.uniform(-scale, scale);
    return v;
  };
  RowMatrix root(n, n);
  for (int i = 0; i < n; ++i) root.row(i) = draw(n, 1.0);
  qp.base_hessian = root * root.transpose() + RowMatrix::Identity(n, n);
  qp.base_gradient = draw(n, 2.0);
  const Eigen::VectorXd point = draw(n, 0.5);
  qp.base_equalities.resize(2, n);
  for (int i = 0; i < 2; ++i) qp.base_equalities.row(i) = draw(n, 1.0);
  qp.base_target = qp.base_equalities * point;
  qp.base_lower = point - draw(n, 0.5).cwiseAbs();
  qp.base_upper = point + draw(n, 0.5).cwiseAbs();

  const int joints = 1 + random.index(4);
  const int steps = 4 + random.index(20);
  qp.arm = random_segment(random, 2, steps, joints, random.index(10), random.chance(0.5));
  // The straight motion need not hold; the arm's own rows do at another one, so give coupled rows
  // what the base alone can make of them.
  for (int i = random.index(20); i > 0; --i) {
    CoupledRow row;
    row.t = 1 + random.index(steps - 1);
    row.base = draw(n, 1.0);
    row.arm = draw(joints, 1.0);
    row.bound = row.base.dot(point) - 3.0 - slack;
    if (random.chance(0.7)) row.arm *= 0.05;
    qp.coupled.push_back(row);
  }
  return qp;
}

// x = base variables, then the arm's inputs.
CondensedQp condense(const MobileQp& qp) {
  const CondensedQp arm = oracle::condense(qp.arm);
  const int nb = qp.num_base();
  const int na = static_cast<int>(arm.gradient.size());
  const int num_equalities = static_cast<int>(qp.base_equalities.rows());
  const int ma = static_cast<int>(arm.rows.rows());
  const int m = num_equalities + nb + ma + static_cast<int>(qp.coupled.size());
  CondensedQp whole;
  whole.hessian = RowMatrix::Zero(nb + na, nb + na);
  whole.hessian.topLeftCorner(nb, nb) = qp.base_hessian;
  whole.hessian.bottomRightCorner(na, na) = arm.hessian;
  whole.gradient.resize(nb + na);
  whole.gradient << qp.base_gradient, arm.gradient;
  whole.rows = RowMatrix::Zero(m, nb + na);
  whole.lower = Eigen::VectorXd::Constant(m, -kInfinity);
  whole.upper = Eigen::VectorXd::Constant(m, kInfinity);
  whole.rows.topLeftCorner(num_equalities, nb) = qp.base_equalities;
  whole.lower.head(num_equalities) = whole.upper.head(num_equalities) = qp.base_target;
  whole.rows.block(num_equalities, 0, nb, nb).setIdentity();
  whole.lower.segment(num_equalities, nb) = qp.base_lower;
  whole.upper.segment(num_equalities, nb) = qp.base_upper;
  whole.rows.block(num_equalities + nb, nb, ma, na) = arm.rows;
  whole.lower.segment(num_equalities + nb, ma) = arm.lower;
  whole.upper.segment(num_equalities + nb, ma) = arm.upper;
  int i = num_equalities + nb + ma;
  for (const CoupledRow& row : qp.coupled) {
    whole.rows.row(i).head(nb) = row.base;
    whole.lower[i] = row.bound;
    for (int j = 0; j < qp.arm.num_joints(); ++j) {
      const int at = nb + j * qp.arm.num_steps;
      whole.rows.block(i, at, 1, qp.arm.num_steps) =
          row.arm[j] * qp.arm.map(Quantity::kPosition, row.t);
      whole.lower[i] -= row.arm[j] * qp.arm.constant(j, Quantity::kPosition, row.t);
    }
    ++i;
  }
  return whole;
}

struct Parts {
  explicit Parts(const MobileQp& qp)
      : kernel(2, qp.arm.weights, 32, 32),
        base(DenseCapacity{16, 64, 128}),
        arm(*kernel, KernelCapacity{32, 128, 128}),
        sum(*base, *arm, SumCapacity{64, 128}) {
    EXPECT_TRUE(base->factorize(qp.num_base(), qp.base_hessian.data()));
    base->reset(qp.base_gradient.data());
    for (int i = 0; i < qp.base_equalities.rows(); ++i) {
      EXPECT_TRUE(
          base->try_add(qp.base_equalities.row(i).data(), qp.base_target[i], qp.base_target[i]));
    }
    EXPECT_TRUE(fill(qp.arm, *arm));
    const int first_base = base->num_rows();
    const int first_arm = arm->num_rows();
    for (const CoupledRow& row : qp.coupled) {
      EXPECT_TRUE(base->try_add(row.base.data(), -kInfinity, kInfinity));
      EXPECT_TRUE(arm->try_add(Quantity::kPosition, row.t, row.arm.data(), -kInfinity));
    }
    for (int j = 0; j < qp.num_base(); ++j) {
      base->set_bounds(j, qp.base_lower[j], qp.base_upper[j]);
    }
    sum->reset();
    for (std::size_t i = 0; i < qp.coupled.size(); ++i) {
      const int k = static_cast<int>(i);
      EXPECT_TRUE(sum->try_add(first_base + k, arm->row_id(first_arm + k), qp.coupled[i].bound));
    }
  }

  InArena<IntegratorKernel<double>> kernel;
  InArena<DenseRows<double>> base;
  InArena<Arm> arm;
  InArena<Sum> sum;
  InArena<ActiveSetQp<double>> solver{128};
};

TEST(SumRows, AgreesWithTheWholeProblemWrittenOutDensely) {
  int num_solved = 0;
  int num_coupled_active = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const MobileQp qp = random_mobile_qp(random, random.uniform(-4.0, 0.0));
    Parts parts(qp);
    const QpResult<double> result = parts.solver->solve(*parts.sum, {}, Deadline());

    const CondensedQp whole = condense(qp);
    const int n = static_cast<int>(whole.gradient.size());
    InArena<DenseRows<double>> dense(DenseCapacity{n, static_cast<int>(whole.rows.rows()), 300});
    InArena<ActiveSetQp<double>> solver(300);
    ASSERT_TRUE(dense->factorize(n, whole.hessian.data()));
    dense->reset(whole.gradient.data());
    for (int i = 0; i < whole.rows.rows(); ++i) {
      ASSERT_TRUE(dense->try_add(whole.rows.row(i).data(), whole.lower[i], whole.upper[i]));
    }
    const QpResult<double> expected = solver->solve(*dense, {}, Deadline());
    ASSERT_EQ(result.status, expected.status) << "seed " << seed;
    if (result.status != QpStatus::kOptimal) continue;
    ++num_solved;
    for (const int id : parts.solver->active_rows()) {
      num_coupled_active += id >= parts.sum->coupled_id(0) ? 1 : 0;
    }
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(dense->primal().data(), n);
    for (int j = 0; j < qp.num_base(); ++j) {
      EXPECT_NEAR(parts.base->primal()[static_cast<std::size_t>(j)], x[j], 1e-9) << "seed " << seed;
    }
    const Eigen::VectorXd inputs = x.tail(n - qp.num_base());
    for (int t = 0; t <= qp.arm.num_steps; ++t) {
      const Eigen::VectorXd q = quantity_at(qp.arm, inputs, Quantity::kPosition, t);
      for (int j = 0; j < qp.arm.num_joints(); ++j) {
        EXPECT_NEAR(parts.arm->value(Quantity::kPosition, t)[j], q[j], 1e-9) << "seed " << seed;
      }
    }
  }
  EXPECT_GE(num_solved, 100);
  EXPECT_GE(num_coupled_active, 100);
}

TEST(SumRows, SoftensCoupledRowsOnly) {
  Random random(7);
  MobileQp qp = random_mobile_qp(random, 0.0);
  qp.coupled.assign(1, {Eigen::VectorXd::Zero(qp.num_base()), 1,
                        Eigen::VectorXd::Zero(qp.arm.num_joints()), 1.0});
  // 0 >= 1 cannot hold; as a soft row it costs what it must and no more.
  Parts parts(qp);
  EXPECT_EQ(parts.solver->solve(*parts.sum, {}, Deadline()).status, QpStatus::kInfeasible);
  EXPECT_EQ(parts.solver->solve(*parts.sum, {}, Deadline()).blocking_row, parts.sum->coupled_id(0));
  parts.sum->set_softness(0.01);
  EXPECT_EQ(parts.solver->solve(*parts.sum, {}, Deadline()).status, QpStatus::kOptimal);
  double multiplier = 0.0;
  for (std::size_t j = 0; j < parts.solver->active_rows().size(); ++j) {
    if (parts.solver->active_rows()[j] != parts.sum->coupled_id(0)) continue;
    multiplier = parts.solver->multipliers()[j];
  }
  EXPECT_NEAR(multiplier, 1.0 / 0.01, 1e-9);
}

TEST(SumRows, RefusesNumbersThatAreNotFiniteInEitherPart) {
  Random random(8);
  const MobileQp good = random_mobile_qp(random, 0.0);
  MobileQp bad = good;
  bad.base_gradient[0] = std::nan("");
  Parts base(bad);
  EXPECT_EQ(base.solver->solve(*base.sum, {}, Deadline()).status, QpStatus::kBadInput);
  bad = good;
  bad.arm.first_position[0] = kInfinity;
  Parts arm(bad);
  EXPECT_EQ(arm.solver->solve(*arm.sum, {}, Deadline()).status, QpStatus::kBadInput);
  bad = good;
  bad.coupled.assign(1, {Eigen::VectorXd::Zero(good.num_base()), 1,
                         Eigen::VectorXd::Zero(good.arm.num_joints()), std::nan("")});
  Parts sum(bad);
  EXPECT_EQ(sum.solver->solve(*sum.sum, {}, Deadline()).status, QpStatus::kBadInput);
}

}  // namespace
