#include "opt/plane/dense_window.h"

#include <algorithm>
#include <limits>

#include "models/simd.h"

namespace sopt {

// As many rows as PointRows may hold, and the two equalities of the end.
DenseWindow::DenseWindow(Arena& arena, int max_window, int max_rows) noexcept
    : rows_(arena, {2 * max_window, max_rows + kLanesDouble * max_window + 2, 2 * max_window}),
      qp_(arena, 2 * max_window),
      hessian_(arena, 4 * max_window * max_window),
      gradient_(arena, 2 * max_window),
      row_(arena, 2 * max_window),
      points_(arena, max_window + 1) {
  for (auto* numbers : {&hessian_, &gradient_, &row_}) {
    (void)numbers->try_resize(numbers->capacity());
    std::fill(numbers->begin(), numbers->end(), 0.0);
  }
  (void)points_.try_resize(points_.capacity());
}

QpResult<double> DenseWindow::solve(PointRows& rows, const QpOptions<double>& options,
                                    const Deadline& deadline) SOPT_RT {
  const bool is_too_long = rows.num_steps() >= points_.capacity();
  if (!rows.is_valid() || is_too_long || !condense(rows)) {
    QpResult<double> result;
    result.status = rows.is_valid() ? QpStatus::kCapacity : QpStatus::kBadInput;
    return result;
  }
  QpResult<double> result = qp_.solve(rows_, options, deadline);
  result.num_active = std::max(0, result.num_active - rows_.num_equalities());  // of `rows`
  if (result.status == QpStatus::kOptimal) write_points(rows);
  return result;
}

bool DenseWindow::condense(const PointRows& rows) SOPT_RT {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int n = rows.num_steps();
  const int num_inputs = 2 * n;
  std::fill_n(hessian_.begin(), num_inputs * num_inputs, 0.0);
  for (int j = 0; j < num_inputs; ++j) hessian_[j * num_inputs + j] = 1.0;
  (void)rows_.factorize(num_inputs, hessian_.begin());
  rows_.reset(gradient_.begin());

  // The step of every time before t moves waypoint t.
  const auto load = [&](int t, const Vec2& normal) {
    std::fill_n(row_.begin(), num_inputs, 0.0);
    for (int s = 0; s < t; ++s) {
      row_[2 * s] = normal.x();
      row_[2 * s + 1] = normal.y();
    }
  };
  const Vec2 first = rows.position(0);
  const Vec2 way = rows.position(n) - first;
  for (int axis = 0; axis < 2; ++axis) {
    load(n, axis == 0 ? Vec2::UnitX() : Vec2::UnitY());
    if (!rows_.try_add(row_.begin(), way[axis], way[axis])) return false;
  }
  for (int id = 0; id < rows.num_ids(); ++id) {
    if (!rows.is_free(id)) continue;
    const PointRows::Row row = rows.row(id);
    load(row.t, row.normal);
    if (!rows_.try_add(row_.begin(), row.bound - row.normal.dot(first), kInfinity)) return false;
  }
  return true;
}

void DenseWindow::write_points(PointRows& rows) SOPT_RT {
  const std::span<const double> steps = rows_.primal();
  points_[0] = rows.position(0);
  for (int t = 0; t < rows.num_steps(); ++t) {
    const auto i = static_cast<std::size_t>(2 * t);
    points_[t + 1] = points_[t] + Vec2(steps[i], steps[i + 1]);
  }
  rows.set_positions(points_.begin());
}

}  // namespace sopt
