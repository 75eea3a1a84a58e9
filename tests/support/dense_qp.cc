#include "tests/support/dense_qp.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace sopt::oracle {
namespace {

using Index = Eigen::Index;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Eigen::MatrixXd SegmentQp::hessian() const {
  const Index size = 2 * (num_steps - 1);
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
  for (Index i = 0; i < size; ++i) {
    h(i, i) = 2.0;
    if (i >= 2) h(i, i - 2) = -1.0;
    if (i + 2 < size) h(i, i + 2) = -1.0;
  }
  return h;
}

Eigen::VectorXd SegmentQp::gradient() const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(2 * (num_steps - 1));
  f.head<2>() -= first;
  f.tail<2>() -= last;
  return f;
}

Eigen::MatrixXd SegmentQp::row_matrix() const {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Index>(rows.size()), 2 * (num_steps - 1));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    a.block<1, 2>(static_cast<Index>(i), 2 * (rows[i].t - 1)) = rows[i].normal.transpose();
  }
  return a;
}

Eigen::MatrixXd SegmentQp::gram() const {
  const Eigen::MatrixXd a = row_matrix();
  return a * hessian().inverse() * a.transpose();
}

Eigen::VectorXd SegmentQp::primal(const Eigen::VectorXd& lambda) const {
  return hessian().ldlt().solve(row_matrix().transpose() * lambda - gradient());
}

double SegmentQp::violation(std::size_t i, const Eigen::VectorXd& x) const {
  return rows[i].bound - rows[i].normal.dot(x.segment<2>(2 * (rows[i].t - 1)));
}

void sort_rows(SegmentQp& qp) {
  std::stable_sort(qp.rows.begin(), qp.rows.end(),
                   [](const SegmentRow& a, const SegmentRow& b) { return a.t < b.t; });
}

bool fill(const SegmentQp& qp, PointRows& rows) {
  rows.reset(qp.num_steps, qp.first, qp.last);
  for (const SegmentRow& row : qp.rows) {
    if (!rows.try_add(row.t, row.normal, row.bound)) return false;
  }
  return true;
}

std::vector<int> row_indices(const SegmentQp& qp) {
  std::vector<int> indices;
  int next = 0;
  for (std::size_t i = 0; i < qp.rows.size(); ++i) {
    const bool begins_waypoint = i > 0 && qp.rows[i].t != qp.rows[i - 1].t;
    if (begins_waypoint) next = (next + kLanesDouble - 1) / kLanesDouble * kLanesDouble;
    indices.push_back(next++);
  }
  return indices;
}

KktResidual kkt_residual(const SegmentQp& qp, const PointRows& rows,
                         const ActiveSetQp<double>& solver) {
  KktResidual residual;
  Eigen::VectorXd x(2 * (qp.num_steps - 1));
  for (int t = 1; t < qp.num_steps; ++t) x.segment<2>(2 * (t - 1)) = rows.position(t);
  const std::vector<int> indices = row_indices(qp);
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(static_cast<Index>(qp.rows.size()));
  for (std::size_t k = 0; k < solver.active_rows().size(); ++k) {
    const auto at = std::find(indices.begin(), indices.end(), solver.active_rows()[k]);
    if (at == indices.end()) {
      residual.has_padding = true;
      continue;
    }
    lambda[at - indices.begin()] += solver.multipliers()[k];
  }
  const Eigen::VectorXd gap =
      qp.hessian() * x + qp.gradient() - qp.row_matrix().transpose() * lambda;
  residual.stationarity = gap.size() > 0 ? gap.cwiseAbs().maxCoeff() : 0.0;
  for (std::size_t i = 0; i < qp.rows.size(); ++i) {
    const double violation = qp.violation(i, x);
    const double multiplier = lambda[static_cast<Index>(i)];
    residual.violation = std::max(residual.violation, violation);
    residual.negativity = std::max(residual.negativity, -multiplier);
    residual.complementarity =
        std::max(residual.complementarity, std::min(multiplier, std::abs(violation)));
  }
  return residual;
}

Certificate2 infeasibility_certificate(const SegmentQp& qp, int row,
                                       const std::vector<int>& others) {
  const auto at = [&](int i) -> const SegmentRow& { return qp.rows[static_cast<std::size_t>(i)]; };
  const Vec2 wanted = -at(row).normal;
  Certificate2 best = {wanted.norm(), 0.0};
  for (const int i : others) {
    for (const int k : others) {
      if (at(i).t != at(row).t || at(k).t != at(row).t) continue;
      const Vec2& a = at(i).normal;
      const Vec2& b = at(k).normal;
      const double det = cross(a, b);
      const bool is_single = std::abs(det) < 1e-12;
      const double share_a = std::max(0.0, is_single ? a.dot(wanted) : cross(wanted, b) / det);
      const double share_b = std::max(0.0, is_single ? 0.0 : cross(a, wanted) / det);
      const double residual = (share_a * a + share_b * b - wanted).norm();
      const double gap = at(row).bound + share_a * at(i).bound + share_b * at(k).bound;
      const bool is_exact = residual < 1e-9;
      if (is_exact ? best.residual < 1e-9 && gap <= best.gap : residual >= best.residual) continue;
      best = {residual, gap};
    }
  }
  return best;
}

SegmentQp random_feasible_qp(Random& random, int num_steps, int num_rows, double slack) {
  SegmentQp qp;
  qp.num_steps = num_steps;
  const Aabb2 box = {Vec2::Constant(-5.0), Vec2::Constant(5.0)};
  qp.first = random.point(box);
  qp.last = random.point(box);
  // A wandering polyline about the line between the ends.
  std::vector<Vec2> inside;
  const double amplitude = random.uniform(0.0, 2.0);
  Vec2 offset = Vec2::Zero();
  for (int t = 0; t <= num_steps; ++t) {
    const double s = static_cast<double>(t) / num_steps;
    offset += 0.5 * amplitude * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    inside.push_back((1.0 - s) * qp.first + s * qp.last + offset);
  }
  const double reach = random.chance(0.5) ? 0.2 : 2.0;
  for (int i = 0; i < num_rows; ++i) {
    SegmentRow row;
    row.t = 1 + random.index(num_steps - 1);
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    row.normal = {std::cos(angle), std::sin(angle)};
    const Vec2& z = inside[static_cast<std::size_t>(row.t)];
    row.bound = row.normal.dot(z) - slack - (random.chance(0.2) ? 0.0 : random.uniform(0, reach));
    qp.rows.push_back(row);
  }
  sort_rows(qp);
  return qp;
}

std::string to_text(const SegmentQp& qp) {
  std::string text = "{\"n\":" + std::to_string(qp.num_steps) + ",\"first\":" + to_text(qp.first) +
                     ",\"last\":" + to_text(qp.last) + ",\"rows\":[";
  char buffer[160];
  for (std::size_t i = 0; i < qp.rows.size(); ++i) {
    const SegmentRow& row = qp.rows[i];
    std::snprintf(buffer, sizeof buffer, "%s[%d,%.17g,%.17g,%.17g]", i > 0 ? "," : "", row.t,
                  row.normal.x(), row.normal.y(), row.bound);
    text += buffer;
  }
  return text + "]}";
}

}  // namespace sopt::oracle
