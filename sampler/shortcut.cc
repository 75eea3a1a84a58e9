#include "sampler/shortcut.h"

#include <algorithm>

#include "sampler/tuning.h"

namespace sopt {
namespace {

// A point of the path: on the motion from vertex i to i + 1.
template <class Robot>
struct PathPoint {
  int i_vertex = 0;
  double from_start = 0.0;  // path length up to it
  typename Robot::Config config{};
};

template <class Robot>
PathPoint<Robot> point_at(const Robot& robot, const Path<Robot>& path, double from_start) SOPT_RT {
  const auto& v = path.vertices;
  double passed = 0.0;
  for (int i = 0; i + 1 < v.size(); ++i) {
    const double length = robot.path_distance(v[i], v[i + 1]);
    if (from_start <= passed + length && length > 0.0) {
      const double share = (from_start - passed) / length;
      return {i, from_start, robot.interpolate(v[i], v[i + 1], share)};
    }
    passed += length;
  }
  return {v.size() - 2, passed, v.back()};
}

// Replaces what lies between `a` and `b` by the motion a -> b.
template <class Robot>
bool splice(Path<Robot>& path, const PathPoint<Robot>& a, const PathPoint<Robot>& b) SOPT_RT {
  auto& v = path.vertices;
  const int first = a.i_vertex + 1;    // first vertex that goes
  const int last = b.i_vertex + 1;     // first vertex that stays
  const int shift = first + 2 - last;  // two new vertices
  const int old_size = v.size();
  if (shift > 0) {
    if (!v.try_resize(old_size + shift)) return false;
    std::copy_backward(v.begin() + last, v.begin() + old_size, v.end());
  } else {
    std::copy(v.begin() + last, v.begin() + old_size, v.begin() + last + shift);
    if (!v.try_resize(old_size + shift)) return false;
  }
  v[first] = a.config;
  v[first + 1] = b.config;
  return true;
}

RequestEnd end_of(int i_vertex, int num_vertices) SOPT_RT {
  if (i_vertex == 0) return RequestEnd::kStart;
  return i_vertex == num_vertices - 1 ? RequestEnd::kGoal : RequestEnd::kNone;
}

// From each kept vertex goes on to the farthest one, at most kMaxSkip ahead, that it sees.
template <class Robot>
void drop_vertices(MotionChecker<Robot>& checker, const Deadline& deadline,
                   Path<Robot>& path) SOPT_RT {
  auto& v = path.vertices;
  const int size = v.size();
  int num_kept = 1;
  bool is_late = false;
  for (int at = 0; at + 1 < size;) {
    int next = std::min(at + kMaxSkip, size - 1);
    while (next > at + 1 && !is_late &&
           !checker.is_clear(v[num_kept - 1], end_of(at, size), v[next], end_of(next, size))) {
      --next;
      is_late = deadline.expired();
    }
    if (is_late) next = at + 1;
    v[num_kept++] = v[next];
    at = next;
  }
  (void)v.try_resize(num_kept);
}

template <class Robot>
void replace_stretches(MotionChecker<Robot>& checker, CounterRng& rng, const Deadline& deadline,
                       Path<Robot>& path) SOPT_RT {
  const Robot& robot = checker.robot();
  double length = path.length(robot);
  for (int i = 0;
       i < SamplerTuning<Robot>::kShortcutTries && path.vertices.size() > 2 && !deadline.expired();
       ++i) {
    const double s = rng.next_uniform() * length;
    const double t = rng.next_uniform() * length;
    const PathPoint<Robot> a = point_at(robot, path, std::min(s, t));
    const PathPoint<Robot> b = point_at(robot, path, std::max(s, t));
    if (a.i_vertex == b.i_vertex) continue;
    const double gain = b.from_start - a.from_start - robot.path_distance(a.config, b.config);
    if (gain <= 1e-9 * length) continue;
    if (!checker.is_clear(a.config, RequestEnd::kNone, b.config, RequestEnd::kNone)) continue;
    if (!splice(path, a, b)) return;
    length -= gain;
  }
}

}  // namespace

template <class Robot>
void shortcut_path(MotionChecker<Robot>& checker, CounterRng& rng, const Deadline& deadline,
                   Path<Robot>& path) SOPT_RT {
  drop_vertices(checker, deadline, path);
  replace_stretches(checker, rng, deadline, path);
  drop_vertices(checker, deadline, path);
  path.unwrap(checker.robot());
}

template void shortcut_path(MotionChecker<Point2>&, CounterRng&, const Deadline&,
                            Path<Point2>&) SOPT_RT;
template void shortcut_path(MotionChecker<Arm<4>>&, CounterRng&, const Deadline&,
                            Path<Arm<4>>&) SOPT_RT;
template void shortcut_path(MotionChecker<Arm<5>>&, CounterRng&, const Deadline&,
                            Path<Arm<5>>&) SOPT_RT;
template void shortcut_path(MotionChecker<Arm<6>>&, CounterRng&, const Deadline&,
                            Path<Arm<6>>&) SOPT_RT;
template void shortcut_path(MotionChecker<Arm<7>>&, CounterRng&, const Deadline&,
                            Path<Arm<7>>&) SOPT_RT;
template void shortcut_path(MotionChecker<Arm<8>>&, CounterRng&, const Deadline&,
                            Path<Arm<8>>&) SOPT_RT;

}  // namespace sopt
