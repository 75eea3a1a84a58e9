// The active-set QP over DenseRows on planted problems: 0 to 40 variables, condition of H 1e0 to
// 1e8, 0 to 100 % of the variables held by rows and bounds. The answer must be the planted one by
// KKT residuals computed apart from the solver, and by x where H is conditioned well enough; from
// the active rows of a similar problem, from nonsense, and in single precision as well. Problems
// with a planted contradiction must be refused, and the rows named must prove it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "tests/support/planted_qp.h"
#include "tests/support/property.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr int kMaxVariables = 40;
constexpr int kMaxRows = 160;
constexpr int kMaxActive = 64;  // variables, and dependent rows set aside
constexpr double kNoLimit = 1e300;

template <class Scalar>
struct Fixture {
  InArena<DenseRows<Scalar>> rows{DenseCapacity{kMaxVariables, kMaxRows, kMaxActive}};
  InArena<ActiveSetQp<Scalar>> solver{kMaxActive};
};

template <class Scalar>
struct Warm {
  std::vector<int> rows;
  std::vector<Scalar> multipliers;
};

template <class Scalar>
struct Answer {
  QpResult<Scalar> result;
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  Warm<Scalar> active;
  double gram_condition = 1.0;  // of its active rows
};

template <class Scalar>
Answer<Scalar> solve(Fixture<Scalar>& f, const DenseQp& qp, const Warm<Scalar>& warm,
                     CaseReport& report) {
  Answer<Scalar> answer;
  if (!fill(qp, *f.rows)) {
    report.fail("the problem does not fit");
    return answer;
  }
  QpOptions<Scalar> options;
  options.warm = {warm.rows, warm.multipliers};
  answer.result = f.solver->solve(*f.rows, options, Deadline());
  const auto active = f.solver->active_rows();
  const auto lambda = f.solver->multipliers();
  answer.active = {{active.begin(), active.end()}, {lambda.begin(), lambda.end()}};
  std::vector<Scalar> multipliers(static_cast<std::size_t>(qp.num_constraints()));
  f.rows->write_multipliers(active, lambda, multipliers.data());
  const auto to_double = [](const auto& values) {
    Eigen::VectorXd result(static_cast<Eigen::Index>(values.size()));
    std::copy(values.begin(), values.end(), result.data());
    return result;
  };
  answer.x = to_double(f.rows->primal());
  answer.multipliers = to_double(multipliers);
  std::vector<int> constraints;
  for (const int id : active) constraints.push_back(f.rows->constraint(id));
  answer.gram_condition = gram_condition(qp, constraints);
  return answer;
}

struct Limits {
  double kkt;
  double x;  // relative to |x|, at least 1
  // Where cond(H) x cond(active rows) is above this, x is known that much worse.
  double condition = 1e10;
};

template <class Scalar>
bool expect_optimal(const char* what, const Answer<Scalar>& answer, CaseReport& report) {
  if (answer.result.status == QpStatus::kOptimal) return true;
  char text[160];
  std::snprintf(text, sizeof text, "%s: status %d after %d steps, primal residual %.3g", what,
                static_cast<int>(answer.result.status), answer.result.num_steps,
                static_cast<double>(answer.result.primal_residual));
  report.fail(text);
  return false;
}

template <class Scalar>
void check_kkt(const char* what, const DenseQp& qp, const Answer<Scalar>& answer,
               const Limits& limits, CaseReport& report) {
  const ScaledKkt kkt = scaled_kkt(qp, answer.x, answer.multipliers);
  const std::string name = what;
  report.expect_within((name + ": stationarity").c_str(), kkt.stationarity, limits.kkt);
  report.expect_within((name + ": violation").c_str(), kkt.violation, limits.kkt);
  report.expect_within((name + ": sign").c_str(), kkt.sign, limits.kkt);
  report.expect_within((name + ": complementarity").c_str(), kkt.complementarity, limits.kkt);
}

double relative_error(const Eigen::VectorXd& x, const Eigen::VectorXd& expected) {
  if (x.size() == 0) return 0.0;
  return (x - expected).norm() / std::max(1.0, expected.norm());
}

template <class Scalar>
void check_answer(const char* what, const PlantedQp& planted, const Eigen::VectorXd& x,
                  const Answer<Scalar>& answer, const Limits& limits, CaseReport& report) {
  if (!expect_optimal(what, answer, report)) return;
  check_kkt(what, planted.qp, answer, limits, report);
  const double condition =
      planted.condition * std::max(planted.gram_condition, answer.gram_condition);
  double limit = limits.x * std::max(1.0, condition / limits.condition);
  // A row that holds within the tolerance without being active leaves x that much freedom.
  for (int c = 0; c < planted.qp.num_constraints(); ++c) {
    if (planted.multipliers[c] != 0.0 && answer.multipliers[c] == 0.0) limit = 1e3 * limits.x;
  }
  report.expect_within((std::string(what) + ": x").c_str(), relative_error(answer.x, x), limit);
}

// Ids, some of which repeat or do not exist, and multipliers that are no numbers or too few.
template <class Scalar>
Warm<Scalar> wrong_warm_start(Random& random, int num_ids) {
  constexpr Scalar kBad[] = {std::numeric_limits<Scalar>::quiet_NaN(),
                             std::numeric_limits<Scalar>::infinity(),
                             -std::numeric_limits<Scalar>::infinity(),
                             Scalar(-1),
                             Scalar(0),
                             std::numeric_limits<Scalar>::max(),
                             std::numeric_limits<Scalar>::denorm_min()};
  Warm<Scalar> warm;
  const int num_rows = random.index(2 * kMaxActive);
  for (int i = 0; i < num_rows; ++i) {
    const int id = random.chance(0.1) ? random.index(100) - 50 : random.index(num_ids + 1);
    warm.rows.push_back(random.chance(0.02) ? std::numeric_limits<int>::max() : id);
  }
  const int num_multipliers = random.chance(0.5) ? 0 : random.index(2 * num_rows + 1);
  for (int i = 0; i < num_multipliers; ++i) {
    warm.multipliers.push_back(random.chance(0.3) ? kBad[random.index(7)]
                                                  : static_cast<Scalar>(random.uniform(-1, 10)));
  }
  return warm;
}

std::string check_double(Random& random, CaseReport& report) {
  static Fixture<double> f;
  const PlantedQp planted = random_planted_qp(random);
  const Limits limits = {1e-11, planted.condition <= 1e5 ? 1e-9 : kNoLimit};
  const auto check = [&](const char* what, const Warm<double>& warm) {
    const Answer<double> answer = solve(f, planted.qp, warm, report);
    check_answer(what, planted, planted.x, answer, limits, report);
    return answer;
  };
  const Answer<double> cold = check("cold", {});
  if (random.chance(0.2)) check("its own active rows", cold.active);
  if (random.chance(0.3)) {
    const DenseQp partner = perturbed_partner(random, planted, 0.03);
    const Answer<double> other = solve(f, partner, {}, report);
    // Its rows are consistent but for rounding, which dependent ones show.
    const bool is_rounding =
        other.result.status == QpStatus::kInaccurate && other.result.primal_residual <= 1e-10;
    if (!is_rounding && expect_optimal("partner", other, report)) {
      check_kkt("partner", partner, other, {1e-10, kNoLimit}, report);
      check("the partner's active rows", other.active);
    }
  }
  if (random.chance(0.3)) {
    check("a wrong warm start", wrong_warm_start<double>(random, f.rows->num_ids()));
  }
  return report.failed() ? to_text(planted.qp) : std::string();
}

// Data are rounded to single precision first; the answer to compare with is the double one.
std::string check_float(Random& random, CaseReport& report) {
  static Fixture<double> exact;
  static Fixture<float> f;
  PlantedQp planted = random_planted_qp(
      random, {.max_condition = 1e3, .min_slack = 1e-3, .has_exact_duplicates = true});
  planted.qp = rounded_to_float(planted.qp);
  const Answer<double> expected = solve(exact, planted.qp, {}, report);
  // Rounded rows that depend on each other may contradict each other.
  if (expected.result.status != QpStatus::kOptimal) return {};
  const Limits limits = {1e-4, 3e-4, 1e3};
  const Answer<float> cold = solve<float>(f, planted.qp, {}, report);
  check_answer("float, cold", planted, expected.x, cold, limits, report);
  const Warm<float> warm =
      random.chance(0.5) ? wrong_warm_start<float>(random, f.rows->num_ids()) : cold.active;
  const Answer<float> again = solve(f, planted.qp, warm, report);
  check_answer("float, warm", planted, expected.x, again, limits, report);
  return report.failed() ? to_text(planted.qp) : std::string();
}

OneSided side_of(const DenseQp& qp, const DenseRows<double>& rows, int id) {
  const int c = rows.constraint(id);
  if (rows.is_upper(id)) return {-qp.normal(c), -qp.upper_of(c)};
  return {qp.normal(c), qp.lower_of(c)};
}

// An equality may be needed either way round.
double best_gap(const DenseQp& qp, Fixture<double>& f, int blocking, const std::vector<int>& others,
                FarkasCertificate& best) {
  const DenseRows<double>& rows = *f.rows;
  std::vector<OneSided> sides;
  int num_free = 0;
  for (const int id : others) {
    sides.push_back(side_of(qp, rows, id));
    num_free += id < rows.num_equalities() ? 1 : 0;
  }
  OneSided row = side_of(qp, rows, blocking);
  best = farkas_certificate(row, sides, num_free);
  if (blocking < rows.num_equalities() && !(best.gap > 0.0)) {
    row = {-row.normal, -row.bound};
    best = farkas_certificate(row, sides, num_free);
  }
  return best.gap;
}

std::string check_infeasible(Random& random, CaseReport& report) {
  static Fixture<double> f;
  DenseQp qp = random_planted_qp(random, {.max_condition = 1e4}).qp;
  add_contradiction(random, std::pow(10.0, random.uniform(-4.0, 1.0)), qp);
  const Answer<double> answer = solve(f, qp, {}, report);
  // Rows that contradict each other only far out may exhaust the arithmetic before: rarely.
  static int num_cases = 0;
  static int num_inaccurate = 0;
  ++num_cases;
  if (answer.result.status == QpStatus::kInaccurate && answer.result.primal_residual > 1e-6) {
    ++num_inaccurate;
    report.expect("contradictions are named", num_inaccurate <= 3 + num_cases / 1000);
    return report.failed() ? to_text(qp) : std::string();
  }
  if (answer.result.status != QpStatus::kInfeasible) {
    report.fail("overlooks the contradiction: status " +
                std::to_string(static_cast<int>(answer.result.status)));
    return to_text(qp);
  }
  const int blocking = answer.result.blocking_row;
  if (blocking < 0 || blocking >= f.rows->num_ids()) {
    report.fail("the blocking row is no row");
    return to_text(qp);
  }
  FarkasCertificate certificate;
  const double gap = best_gap(qp, f, blocking, answer.active.rows, certificate);
  report.expect_within("certificate combines to zero", certificate.residual, 1e-7);
  report.expect_within("certificate has the signs", certificate.negativity, 1e-7);
  report.expect("certificate contradicts itself", gap > 0.0);
  return report.failed() ? to_text(qp) : std::string();
}

std::string check_case(Random& random, CaseReport& report) {
  const int kind = random.index(10);
  if (kind < 6) return check_double(random, report);
  return kind < 8 ? check_float(random, report) : check_infeasible(random, report);
}

}  // namespace

int main(int argc, char** argv) { return run_property("planted_qp", argc, argv, check_case); }
