#include "tools/qp/segment_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "sampler/rng.h"
#include "tools/qp/qp_families.h"
#include "tools/qp/unicycle_base.h"

namespace sopt {
namespace {

using Vector = std::vector<double>;

Vector random_vector(CounterRng& rng, std::size_t size, double scale) {
  Vector v(size);
  for (double& x : v) x = scale * (2.0 * rng.next_uniform() - 1.0);
  return v;
}

double dot(const Vector& a, const double* b) {
  return std::inner_product(a.begin(), a.end(), b, 0.0);
}

// Positions and velocities of the joints when driven by inputs in the condensed order.
struct Rollout {
  std::vector<Vector> position, velocity;  // times 0 .. n
  std::vector<Vector> input;               // times 0 .. n - 1

  Rollout(const SegmentQp& problem, const Vector& inputs) {
    const KernelPart<double>& arm = problem.arm;
    const auto num_joints = static_cast<std::size_t>(arm.num_joints);
    position.push_back(arm.first_position);
    velocity.push_back(arm.order == 2 ? arm.first_velocity : Vector(num_joints, 0.0));
    const double* u = inputs.data();
    for (int t = 0; t < arm.num_steps; ++t, u += arm.num_joints) {
      u += problem.base.num_inputs;
      input.emplace_back(u, u + arm.num_joints);
      Vector q = position.back();
      Vector v = velocity.back();
      for (std::size_t j = 0; j < num_joints; ++j) {
        q[j] += arm.order == 2 ? v[j] + 0.5 * u[j] : u[j];
        v[j] += arm.order == 2 ? u[j] : 0.0;
      }
      position.push_back(q);
      velocity.push_back(v);
    }
  }

  [[nodiscard]] double cost(const KernelPart<double>& arm) const {
    double sum = 0.0;
    for (std::size_t t = 0; t < input.size(); ++t) {
      for (std::size_t j = 0; j < input[t].size(); ++j) {
        const double factor = arm.factors.empty() ? 1.0 : arm.factors[j];
        const double q = position[t + 1][j] - arm.attractor[j];
        const double v = arm.order == 2 ? velocity[t + 1][j] : input[t][j];
        const double a = arm.order == 2 ? input[t][j] : 0.0;
        sum += 0.5 * factor *
               (arm.weights.position * q * q + arm.weights.velocity * v * v +
                arm.weights.acceleration * a * a);
      }
    }
    return sum;
  }
};

double objective(const QpProblem& problem, const Vector& x) {
  double sum = dot(problem.gradient, x.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += 0.5 * x[i] * dot(x, problem.hessian.data() + i * x.size());
  }
  return sum;
}

// How far inside row i the inputs are.
double distance_to_lower(const QpProblem& problem, std::size_t i, const Vector& x) {
  return dot(x, problem.rows.data() + i * x.size()) - problem.row_lower[i];
}

SegmentQp problem_of(char family) {
  SegmentQp problem = make_qp_family(family, 3, 7).pairs.back().cold;
  if (family != 'd') {
    problem.arm.factors = Vector(static_cast<std::size_t>(problem.arm.num_joints), 1.0);
    problem.arm.factors.back() = 2.5;
  }
  return problem;
}

TEST(CondenseTest, CostIsThatOfARolloutButForAConstant) {
  for (const char family : {'a', 'b'}) {
    const SegmentQp problem = problem_of(family);
    const QpProblem condensed = condense(problem, "p");
    CounterRng rng(3);
    const Vector zero(condensed.gradient.size(), 0.0);
    const double constant = Rollout(problem, zero).cost(problem.arm);
    for (int i = 0; i < 5; ++i) {
      const Vector u = random_vector(rng, zero.size(), 0.3);
      const double cost = Rollout(problem, u).cost(problem.arm);
      EXPECT_NEAR(objective(condensed, u) + constant, cost, 1e-11 * std::max(1.0, cost));
    }
  }
}

TEST(CondenseTest, RowsAreThoseOfARollout) {
  for (const char family : {'a', 'b', 'c'}) {
    const SegmentQp problem = problem_of(family);
    const KernelPart<double>& arm = problem.arm;
    const QpProblem condensed = condense(problem, "p");
    CounterRng rng(4);
    const Vector u = random_vector(rng, condensed.gradient.size(), 0.3);
    const Rollout rollout(problem, u);
    const std::size_t first = condensed.row_lower.size() - arm.rows.size();
    for (std::size_t i = 0; i < arm.rows.size(); ++i) {
      const KernelRow<double>& row = arm.rows[i];
      const double value =
          dot(row.direction, rollout.position[static_cast<std::size_t>(row.t)].data());
      EXPECT_NEAR(distance_to_lower(condensed, first + i, u), value - row.bound, 1e-11);
    }
  }
}

TEST(CondenseTest, EqualitiesHoldTheEnds) {
  const SegmentQp problem = problem_of('b');
  const QpProblem condensed = condense(problem, "p");
  ASSERT_EQ(condensed.num_equalities, 10);
  CounterRng rng(5);
  const Vector u = random_vector(rng, condensed.gradient.size(), 0.3);
  const Rollout rollout(problem, u);
  for (std::size_t j = 0; j < 5; ++j) {
    EXPECT_EQ(condensed.row_lower[2 * j], condensed.row_upper[2 * j]);
    EXPECT_NEAR(distance_to_lower(condensed, 2 * j, u),
                rollout.position.back()[j] - problem.arm.last_position[j], 1e-11);
    EXPECT_NEAR(distance_to_lower(condensed, 2 * j + 1, u),
                rollout.velocity.back()[j] - problem.arm.last_velocity[j], 1e-11);
  }
}

TEST(CondenseTest, BoundsOfTheInputAreBoundsAndThoseOfVelocitiesAreRows) {
  const SegmentQp problem = problem_of('b');
  const QpProblem condensed = condense(problem, "p");
  const KernelBounds<double>& input = problem.arm.bounds[0];
  const KernelBounds<double>& velocity = problem.arm.bounds[1];
  ASSERT_EQ(input.quantity, Quantity::kAcceleration);
  ASSERT_EQ(velocity.quantity, Quantity::kVelocity);
  for (const double bound : condensed.lower) EXPECT_EQ(bound, input.lower[0]);
  for (const double bound : condensed.upper) EXPECT_EQ(bound, input.upper[0]);
  CounterRng rng(6);
  const Vector u = random_vector(rng, condensed.gradient.size(), 0.3);
  const Rollout rollout(problem, u);
  std::size_t i = 10;
  for (std::size_t t = 1; t <= 29; ++t) {
    for (std::size_t j = 0; j < 5; ++j, ++i) {
      EXPECT_NEAR(distance_to_lower(condensed, i, u), rollout.velocity[t][j] - velocity.lower[j],
                  1e-11);
      EXPECT_NEAR(condensed.row_upper[i] - condensed.row_lower[i],
                  velocity.upper[j] - velocity.lower[j], 1e-11);
    }
  }
}

TEST(CondenseTest, CoupledRowsAddBaseAndArm) {
  const SegmentQp problem = problem_of('d');
  const QpProblem condensed = condense(problem, "p");
  EXPECT_EQ(condensed.num_variables, 180);
  EXPECT_EQ(condensed.num_equalities, 11);
  CounterRng rng(7);
  const Vector u = random_vector(rng, condensed.gradient.size(), 0.1);
  Vector base;
  for (std::size_t i = 0; i < u.size(); i += 6) base.insert(base.end(), {u[i], u[i + 1]});
  const Rollout rollout(problem, u);
  const std::size_t first = condensed.row_lower.size() - problem.coupled.size();
  for (std::size_t i = 0; i < problem.coupled.size(); ++i) {
    const CoupledRow& row = problem.coupled[i];
    const double value = dot(row.base, base.data()) +
                         dot(row.arm, rollout.position[static_cast<std::size_t>(row.t)].data());
    EXPECT_NEAR(distance_to_lower(condensed, first + i, u), value - row.bound, 1e-11);
  }
}

TEST(UnicycleBaseTest, RowsAreTheDerivativeOfTheDrivenPose) {
  CounterRng rng(8);
  UnicycleReference reference = {random_vector(rng, 12, 0.2), random_vector(rng, 12, 0.2)};
  const UnicycleCost cost = {0.1, 0.2};
  const UnicycleLimits limits = {1.0, 1.0};
  const UnicycleBase base(reference, cost, limits);
  const double step = 1e-6;
  for (std::size_t i = 0; i < 24; ++i) {
    const auto moved = [&](double by) {
      UnicycleReference other = reference;
      (i % 2 == 0 ? other.v : other.w)[i / 2] += by;
      return UnicycleBase(other, cost, limits).poses();
    };
    const auto ahead = moved(step);
    const auto behind = moved(-step);
    for (int t = 0; t <= 12; ++t) {
      const Vector& after = ahead[static_cast<std::size_t>(t)];
      const Vector& before = behind[static_cast<std::size_t>(t)];
      for (std::size_t k = 0; k < 3; ++k) {
        double direction[3] = {};
        direction[k] = 1.0;
        EXPECT_NEAR(base.row(t, direction)[i], (after[k] - before[k]) / (2.0 * step), 1e-8);
      }
    }
  }
}

TEST(UnicycleBaseTest, CostIsThatOfTheLinearisedPosesAndTheInputs) {
  CounterRng rng(9);
  const UnicycleReference reference = {random_vector(rng, 8, 0.2), random_vector(rng, 8, 0.2)};
  const UnicycleBase base(reference, {0.1, 0.2}, {1.0, 1.0});
  const auto cost_at = [&](const Vector& u) {
    double sum = 0.0;
    for (std::size_t t = 0; t < 8; ++t) {
      sum += 0.5 * std::pow(reference.v[t] + u[2 * t], 2);
      sum += 0.5 * std::pow(reference.w[t] + u[2 * t + 1], 2);
      for (std::size_t k = 0; k < 3; ++k) {
        double direction[3] = {};
        direction[k] = 1.0;
        const double moved = dot(base.row(static_cast<int>(t) + 1, direction), u.data());
        const double away = base.poses()[t + 1][k] + moved - base.poses().back()[k];
        sum += 0.5 * (k == 2 ? 0.2 : 0.1) * away * away;
      }
    }
    return sum;
  };
  QpProblem problem;
  problem.hessian = base.part().hessian;
  problem.gradient = base.part().gradient;
  const Vector u = random_vector(rng, 16, 0.5);
  EXPECT_NEAR(objective(problem, u), cost_at(u) - cost_at(Vector(16, 0.0)), 1e-12);
  for (std::size_t t = 0; t < 8; ++t) {
    EXPECT_DOUBLE_EQ(base.part().lower[2 * t], -reference.v[t]);
    EXPECT_DOUBLE_EQ(base.part().upper[2 * t], 1.0 - reference.v[t]);
    EXPECT_DOUBLE_EQ(base.part().lower[2 * t + 1], -1.0 - reference.w[t]);
    EXPECT_DOUBLE_EQ(base.part().upper[2 * t + 1], 1.0 - reference.w[t]);
  }
}

}  // namespace
}  // namespace sopt
