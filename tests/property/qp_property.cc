// The active-set QP on random segments: n 2..60, 0..200 rows, some of them duplicate, nearly
// parallel, opposite or contradictory. Feasible by construction: the KKT conditions must hold,
// computed densely apart from the solver. Infeasible by construction: it must refuse, and rows that
// it names must prove it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/dense_qp.h"
#include "tests/support/property.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kPi = 3.14159265358979323846;

struct Fixture {
  InArena<PointRows> rows{60, 512};
  InArena<ActiveSetQp<double>> solver{128};
};

// Rows that make life hard without cutting off the point that all rows hold at.
void add_awkward_rows(Random& random, SegmentQp& qp) {
  const std::vector<SegmentRow> drawn = qp.rows;
  for (SegmentRow row : drawn) {
    if (random.chance(0.7)) continue;
    const int kind = random.index(3);
    if (kind == 1) {
      const double angle = std::pow(10.0, random.uniform(-14.0, -2.0));
      row.normal = Eigen::Rotation2Dd(angle) * row.normal;
      row.bound -= 200.0 * angle;
    } else if (kind == 2) {
      // The other side of a corridor.
      row.normal = -row.normal;
      row.bound = -row.bound - 2.5;
    }
    qp.rows.push_back(row);
  }
  sort_rows(qp);
}

void add_contradiction(Random& random, SegmentQp& qp) {
  const int t = 1 + random.index(qp.num_steps - 1);
  const double turn = random.uniform(0.0, 2.0 * kPi);
  const Vec2 z = random.point({Vec2::Constant(-5.0), Vec2::Constant(5.0)});
  const int num_sides = 2 + random.index(3);
  for (int k = 0; k < num_sides; ++k) {
    const double angle = turn + 2.0 * kPi * k / num_sides;
    const Vec2 normal = {std::cos(angle), std::sin(angle)};
    qp.rows.push_back({t, normal, normal.dot(z) + std::pow(10.0, random.uniform(-6.0, 0.0))});
  }
  sort_rows(qp);
}

void check_optimum(Fixture& f, const SegmentQp& qp, const QpResult<double>& result,
                   CaseReport& report) {
  if (result.status != QpStatus::kOptimal) {
    char text[120];
    std::snprintf(text, sizeof text, "misses the optimum: status %d, primal residual %.3g",
                  static_cast<int>(result.status), result.primal_residual);
    report.fail(text);
    return;
  }
  const KktResidual residual = kkt_residual(qp, *f.rows, *f.solver);
  report.expect_within("feasibility", residual.violation, 1.0001e-9);
  report.expect_within("stationarity", residual.stationarity, 1e-9);
  report.expect("multipliers are not negative", residual.negativity <= 0.0);
  report.expect_within("complementarity", residual.complementarity, 1e-8);
  report.expect("no padding row is active", !residual.has_padding);
}

void check_infeasible(Fixture& f, const SegmentQp& qp, const QpResult<double>& result,
                      CaseReport& report) {
  if (result.status != QpStatus::kInfeasible) {
    report.fail("overlooks the contradiction: status " +
                std::to_string(static_cast<int>(result.status)));
    return;
  }
  const std::vector<int> indices = row_indices(qp);
  const auto position = [&](int row) {
    return static_cast<int>(std::find(indices.begin(), indices.end(), row) - indices.begin());
  };
  const int blocking = position(result.blocking_row);
  if (blocking >= static_cast<int>(qp.rows.size())) {
    report.fail("the blocking row is no row");
    return;
  }
  std::vector<int> others;
  for (const int row : f.solver->active_rows()) {
    if (position(row) != blocking) others.push_back(position(row));
  }
  const Certificate2 certificate = infeasibility_certificate(qp, blocking, others);
  report.expect_within("certificate combines to zero", certificate.residual, 1e-5);
  report.expect("certificate contradicts itself", certificate.gap > 0.0);
}

std::string check_case(Random& random, CaseReport& report) {
  static Fixture f;
  const bool is_feasible = random.chance(0.8);
  const double slack = random.chance(0.5) ? 0.0 : std::pow(10.0, random.uniform(-8.0, -1.0));
  SegmentQp qp = random_feasible_qp(random, 2 + random.index(59), random.index(201), slack);
  if (random.chance(0.5)) add_awkward_rows(random, qp);
  if (!is_feasible) add_contradiction(random, qp);
  if (!fill(qp, *f.rows)) {
    report.fail("the rows do not fit");
    return to_text(qp);
  }
  const QpResult<double> result = f.solver->solve(*f.rows, QpOptions<double>{}, Deadline());
  if (is_feasible) {
    check_optimum(f, qp, result, report);
  } else {
    check_infeasible(f, qp, result, report);
  }
  return report.failed() ? to_text(qp) : std::string();
}

}  // namespace

int main(int argc, char** argv) { return run_property("qp", argc, argv, check_case); }
