// The QP of an arm's window: joints that weigh differently are the same as joints measured in
// other units, and both solvers say so.
#include "opt/arm/arm_qp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "opt/step_measure.h"
#include "tests/support/oracle2.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

constexpr int kDof = 5;
using Config = Arm<kDof>::Config;

struct DrawnSegment {
  ArmSegment<kDof> segment;
  std::vector<ArmRow<kDof>> rows;
  std::vector<Config> lower, upper;

  void link() {
    segment.rows = rows;
    segment.lower = lower;
    segment.upper = upper;
  }
};

Config random_config(Random& random, double reach) {
  Config q;
  for (int j = 0; j < kDof; ++j) q[j] = random.uniform(-reach, reach);
  return q;
}

// From one place to another at rest, pushed aside by a few rows, with velocities that a few joints
// reach.
void draw(Random& random, DrawnSegment& out) {
  ArmSegment<kDof>& s = out.segment;
  s.num_steps = 10 + random.index(30);
  s.first_position = random_config(random, 1.0);
  s.last_position = random_config(random, 1.0);
  s.first_velocity = s.last_velocity = Config::Zero();
  const Config way = s.last_position - s.first_position;
  s.v_max = 1.6 / s.num_steps * way.cwiseAbs() + Config::Constant(0.05);
  s.a_max = Config::Constant(1.0);
  out.rows.clear();
  for (int t = 2; t < s.num_steps - 1; t += 1 + random.index(6)) {
    const Config gradient = random_config(random, 0.5);
    const Config on_line = s.first_position + (way * t) / s.num_steps;
    out.rows.push_back({t, gradient, gradient.dot(on_line) + random.uniform(-0.02, 0.02), 0.0});
  }
  const auto num_waypoints = static_cast<std::size_t>(s.num_steps) + 1;
  out.lower.assign(num_waypoints, Config::Constant(-1.2));
  out.upper.assign(num_waypoints, Config::Constant(1.2));
  out.link();
}

// The same segment in units in which joint j is weights[j] times as large.
DrawnSegment scaled(const DrawnSegment& drawn, const Config& weights) {
  DrawnSegment out = drawn;
  ArmSegment<kDof>& s = out.segment;
  for (Config* q : {&s.first_position, &s.last_position, &s.first_velocity, &s.last_velocity,
                    &s.v_max, &s.a_max}) {
    *q = q->cwiseProduct(weights);
  }
  for (auto& row : out.rows) row.gradient = row.gradient.cwiseQuotient(weights);
  for (auto* bounds : {&out.lower, &out.upper}) {
    for (Config& q : *bounds) q = q.cwiseProduct(weights);
  }
  out.link();
  return out;
}

class ArmQpTest : public ::testing::Test {
 protected:
  static PlannerSettings settings() {
    PlannerSettings settings = PlannerSettings::arm();
    settings.max_window = 40;
    settings.dense_solver = true;
    return settings;
  }
  // Positions of all waypoints; none when there is no solution.
  std::vector<Config> solve(const ArmSegment<kDof>& segment, WindowSolver solver) {
    std::vector<Config> positions;
    const QpResult<double> result = qp_->solve(segment, solver, Deadline());
    if (result.status != QpStatus::kOptimal) return positions;
    num_active_ += result.num_active;
    for (int t = 1; t < segment.num_steps; ++t) positions.push_back(qp_->position(t));
    return positions;
  }

  int num_active_ = 0;
  InArena<IntegratorKernel<double>> kernel_{2, IntegratorWeights{0.0, 1.0, kArmInputWeight}, 40,
                                            40};
  InArena<ArmQp<kDof>> qp_{settings(), *kernel_};
};

TEST_F(ArmQpTest, WeightsAreUnits) {
  Random random(1);
  int num_solved = 0;
  for (int round = 0; round < 200; ++round) {
    DrawnSegment drawn;
    draw(random, drawn);
    Config weights;
    for (int j = 0; j < kDof; ++j) weights[j] = std::exp2(random.uniform(-3.0, 3.0));
    drawn.segment.factors = weights.cwiseAbs2();
    DrawnSegment expected = scaled(drawn, weights);
    expected.segment.factors.setOnes();
    const auto in_units = solve(expected.segment, WindowSolver::kClosedForm);
    for (const WindowSolver solver : {WindowSolver::kClosedForm, WindowSolver::kDense}) {
      const auto weighted = solve(drawn.segment, solver);
      ASSERT_EQ(weighted.size(), in_units.size()) << round;
      for (std::size_t i = 0; i < weighted.size(); ++i) {
        const Config error = weighted[i] - in_units[i].cwiseQuotient(weights);
        EXPECT_LE(error.cwiseAbs().maxCoeff(), 1e-6) << round << ' ' << i;
      }
    }
    num_solved += in_units.empty() ? 0 : 1;
  }
  EXPECT_GT(num_solved, 100);
  EXPECT_GT(num_active_, 300);
}

// What a heavy joint leaves undone the others do.
TEST_F(ArmQpTest, HeavyJointsYieldLess) {
  DrawnSegment drawn;
  ArmSegment<kDof>& s = drawn.segment;
  s.num_steps = 20;
  s.first_position = s.last_position = s.first_velocity = s.last_velocity = Config::Zero();
  s.v_max = s.a_max = Config::Constant(10.0);
  drawn.lower.assign(21, Config::Constant(-10.0));
  drawn.upper.assign(21, Config::Constant(10.0));
  drawn.rows.push_back({10, (Config() << 1.0, 1.0, 0.0, 0.0, 0.0).finished(), 1.0, 0.0});
  drawn.link();
  // min (r_0 q_0^2 + r_1 q_1^2) with q_0 + q_1 = 1: q_0 = r_1 / (r_0 + r_1).
  for (const double weight : {1.0, 2.0, 10.0}) {
    s.factors.setOnes();
    s.factors[0] = weight * weight;
    for (const WindowSolver solver : {WindowSolver::kClosedForm, WindowSolver::kDense}) {
      const auto positions = solve(s, solver);
      ASSERT_EQ(positions.size(), 19u);
      EXPECT_NEAR(positions[9][0], 1.0 / (weight * weight + 1.0), 1e-9);
      EXPECT_NEAR(positions[9][1], weight * weight / (weight * weight + 1.0), 1e-9);
    }
  }
}

}  // namespace
}  // namespace sopt
