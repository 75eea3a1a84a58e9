#include "sampler/lattice_search.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

constexpr double kDiagonal = 1.4142135623730951;  // of a cell, in spacings
// Start and goal see lattice points up to this many spacings away on an axis.
constexpr double kEndReach = 2.0;

}  // namespace

LatticeSearch<Point2>::LatticeSearch(Arena& arena, int max_points) noexcept
    : points_(arena, max_points + 1), heap_(arena, max_points + 1) {}

bool LatticeSearch<Point2>::find_path(Checker& checker, const Vec2& start, const Vec2& goal,
                                      int first_level, const Deadline& deadline,
                                      Path<Point2>& out) SOPT_RT {
  out.vertices.clear();
  start_ = start;
  goal_ = goal;
  for (int level = first_level; level < kLatticeLevels; ++level) {
    if (!lay_out(checker.sampling_box(), kCoarsestPoints << (2 * level))) return false;
    if (search(checker, deadline)) return store_path(out);
    if (deadline.expired()) return false;
  }
  return false;
}

// About `num_points` of one spacing over the box; false when they do not fit or the box is empty.
bool LatticeSearch<Point2>::lay_out(const Aabb2& box, int num_points) SOPT_RT {
  const Vec2 size = box.upper - box.lower;
  if (!(size.minCoeff() > 0.0)) return false;
  spacing_m_ = std::max(std::sqrt(size.prod() / num_points), size.maxCoeff() / num_points);
  num_columns_ = static_cast<int>(size.x() / spacing_m_) + 1;
  num_rows_ = static_cast<int>(size.y() / spacing_m_) + 1;
  const Vec2 span = spacing_m_ * Vec2(num_columns_ - 1, num_rows_ - 1);
  origin_ = box.lower + 0.5 * (size - span);
  points_.clear();
  heap_.clear();
  if (!points_.try_resize(num_columns_ * num_rows_ + 1)) return false;
  std::fill(points_.begin(), points_.end(), Point{});
  return true;
}

bool LatticeSearch<Point2>::search(Checker& checker, const Deadline& deadline) SOPT_RT {
  leave_start(checker);
  for (int i = 0; !heap_.empty(); ++i) {
    const int point = pop();
    settle(checker, point);
    if (is_goal(point)) return true;
    if (i % kDeadlineStride == 0 && deadline.expired()) return false;
    expand(checker, point);
  }
  return false;
}

void LatticeSearch<Point2>::leave_start(Checker& checker) SOPT_RT {
  const Vec2 at = (start_ - origin_) / spacing_m_;
  const auto first = [](double v) {
    return std::max(0, static_cast<int>(std::ceil(v - kEndReach)));
  };
  const auto last = [](double v, int num) {
    return std::min(num - 1, static_cast<int>(std::floor(v + kEndReach)));
  };
  for (int row = first(at.y()); row <= last(at.y(), num_rows_); ++row) {
    for (int column = first(at.x()); column <= last(at.x(), num_columns_); ++column) {
      const int point = row * num_columns_ + column;
      const bool is_free = excess(checker, point) != kBlocked;
      if (is_free && sees(checker, kNoPoint, point)) open(point, kNoPoint, kNoPoint);
    }
  }
}

// The parent was taken on trust; when it is out of sight the neighbour takes its place.
void LatticeSearch<Point2>::settle(Checker& checker, int point) SOPT_RT {
  Point& settled = points_[point];
  settled.is_closed = true;
  if (settled.parent == settled.neighbor || sees(checker, settled.parent, point)) return;
  settled.parent = settled.neighbor;
  settled.from_start = length_through(settled.neighbor, point);
}

// Goes on from `point` to its neighbours, and to the goal when that is near.
void LatticeSearch<Point2>::expand(Checker& checker, int point) SOPT_RT {
  const int row = point / num_columns_;
  const int column = point % num_columns_;
  for (int to_row = std::max(0, row - 1); to_row <= std::min(num_rows_ - 1, row + 1); ++to_row) {
    const int last = std::min(num_columns_ - 1, column + 1);
    for (int to_column = std::max(0, column - 1); to_column <= last; ++to_column) {
      try_reach(checker, point, to_row * num_columns_ + to_column);
    }
  }
  const Vec2 to_goal = goal_ - position(point);
  if (to_goal.cwiseAbs().maxCoeff() <= kEndReach * spacing_m_) {
    try_reach(checker, point, points_.size() - 1);
  }
}

void LatticeSearch<Point2>::try_reach(Checker& checker, int from, int point) SOPT_RT {
  const Point& to = points_[point];
  const int parent = points_[from].parent;
  const bool is_open = to.heap_slot != kNoPoint;
  if (to.is_closed || (is_open && length_through(parent, point) >= to.from_start)) return;
  if (!is_goal(point) && excess(checker, point) == kBlocked) return;
  if (is_held(checker, from, point) || sees(checker, from, point)) open(point, parent, from);
}

// Two discs without obstacles that overlap hold the motion between their centers.
bool LatticeSearch<Point2>::is_held(Checker& checker, int from, int point) SOPT_RT {
  if (is_goal(point)) return false;
  const double length = (position(point) - position(from)).norm();
  return excess(checker, from) + excess(checker, point) > static_cast<float>(length);
}

void LatticeSearch<Point2>::open(int point, int parent, int neighbor) SOPT_RT {
  Point& opened = points_[point];
  opened.parent = parent;
  opened.neighbor = neighbor;
  opened.from_start = length_through(parent, point);
  opened.total = opened.from_start + static_cast<float>((goal_ - position(point)).norm());
  if (opened.heap_slot == kNoPoint) {
    opened.heap_slot = heap_.size();
    (void)heap_.try_push_back(point);  // as large as the lattice
  }
  push_up(opened.heap_slot);
}

bool LatticeSearch<Point2>::sees(Checker& checker, int from, int point) const SOPT_RT {
  const Vec2 to = position(point);
  const RequestEnd to_end = is_goal(point) ? RequestEnd::kGoal : RequestEnd::kNone;
  if (from == kNoPoint) return checker.is_clear(start_, RequestEnd::kStart, to, to_end);
  return checker.is_clear(position(from), RequestEnd::kNone, to, to_end);
}

float LatticeSearch<Point2>::length_through(int parent, int point) const SOPT_RT {
  if (parent == kNoPoint) return static_cast<float>((position(point) - start_).norm());
  return points_[parent].from_start +
         static_cast<float>((position(point) - position(parent)).norm());
}

float LatticeSearch<Point2>::excess(Checker& checker, int point) SOPT_RT {
  float& excess_m = points_[point].excess_m;
  if (excess_m == kUnseen) {
    const Vec2 q = position(point);
    excess_m = static_cast<float>(checker.excess_clearance(q, kDiagonal * spacing_m_));
    if (excess_m <= 0.0F) {
      const bool is_clear = checker.is_clear(q, RequestEnd::kNone, q, RequestEnd::kNone);
      excess_m = is_clear ? 0.0F : kBlocked;
    }
  }
  return excess_m;
}

Vec2 LatticeSearch<Point2>::position(int point) const SOPT_RT {
  if (point == points_.size() - 1) return goal_;
  return origin_ + spacing_m_ * Vec2(point % num_columns_, point / num_columns_);
}

bool LatticeSearch<Point2>::store_path(Path<Point2>& out) const SOPT_RT {
  auto& vertices = out.vertices;
  bool fits = true;
  for (int i = points_.size() - 1; i != kNoPoint && fits; i = points_[i].parent) {
    fits = vertices.try_push_back(position(i));
  }
  fits = fits && vertices.try_push_back(start_);
  std::reverse(vertices.begin(), vertices.end());
  if (!fits) vertices.clear();
  return fits;
}

void LatticeSearch<Point2>::push_up(int slot) SOPT_RT {
  const std::int32_t point = heap_[slot];
  const float total = points_[point].total;
  while (slot > 0) {
    const int above = (slot - 1) / 2;
    if (points_[heap_[above]].total <= total) break;
    heap_[slot] = heap_[above];
    points_[heap_[slot]].heap_slot = slot;
    slot = above;
  }
  heap_[slot] = point;
  points_[point].heap_slot = slot;
}

// Takes the open point with the smallest total.
int LatticeSearch<Point2>::pop() SOPT_RT {
  const std::int32_t top = heap_[0];
  const std::int32_t moved = heap_.back();
  const int size = heap_.size() - 1;
  (void)heap_.try_resize(size);
  for (int slot = 0; size > 0;) {
    int child = 2 * slot + 1;
    if (child + 1 < size && points_[heap_[child + 1]].total < points_[heap_[child]].total) ++child;
    if (child >= size || points_[heap_[child]].total >= points_[moved].total) {
      heap_[slot] = moved;
      points_[moved].heap_slot = slot;
      break;
    }
    heap_[slot] = heap_[child];
    points_[heap_[slot]].heap_slot = slot;
    slot = child;
  }
  return top;
}

}  // namespace sopt
