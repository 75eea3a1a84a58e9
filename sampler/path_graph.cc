#include "sampler/path_graph.h"

#include <algorithm>

namespace sopt {

template <class Robot>
PathGraph<Robot>::PathGraph(Arena& arena) noexcept
    : nodes_(arena, kMaxGraphNodes), queue_(arena, kMaxGraphNodes * kMaxGraphNodes) {}

template <class Robot>
void PathGraph<Robot>::reset(const Robot& robot) SOPT_RT {
  robot_ = &robot;
  nodes_.clear();
}

template <class Robot>
void PathGraph<Robot>::add(const Path<Robot>& path) SOPT_RT {
  const auto& v = path.vertices;
  const auto new_node = [&](const Config& config) {
    Node node;
    node.config = config;
    node.to_goal = robot_->path_distance(config, v.back());
    return node;
  };
  if (nodes_.empty()) {
    (void)nodes_.try_push_back(new_node(v[0]));
    (void)nodes_.try_push_back(new_node(v.back()));
  }
  const int first = nodes_.size();
  const int num_inner = v.size() - 2;
  if (first + num_inner > nodes_.capacity()) return;
  for (int i = 0; i < num_inner; ++i) {
    (void)nodes_.try_push_back(new_node(v[i + 1]));
    nodes_.back().next_on_path = i + 1 < num_inner ? first + i + 1 : kGoal;
  }
}

template <class Robot>
RequestEnd PathGraph<Robot>::end_of(int i) const SOPT_RT {
  if (i == kStart) return RequestEnd::kStart;
  return i == kGoal ? RequestEnd::kGoal : RequestEnd::kNone;
}

template <class Robot>
bool PathGraph<Robot>::are_neighbors(int a, int b) const SOPT_RT {
  return nodes_[a].next_on_path == b || nodes_[b].next_on_path == a;
}

// Settles node `i` and queues the motions on from it that can still beat the limit.
template <class Robot>
void PathGraph<Robot>::close(int i, int parent, double length_limit) SOPT_RT {
  Node& node = nodes_[i];
  node.is_closed = true;
  node.parent = parent;
  if (parent >= 0) {
    node.from_start =
        nodes_[parent].from_start + robot_->path_distance(nodes_[parent].config, node.config);
  }
  for (int k = 0; k < nodes_.size(); ++k) {
    const Node& next = nodes_[k];
    if (next.is_closed) continue;
    const double through =
        node.from_start + robot_->path_distance(node.config, next.config) + next.to_goal;
    if (through >= length_limit || !queue_.try_push_back({through, i, k})) continue;
    std::push_heap(queue_.begin(), queue_.end(), is_later);
  }
}

template <class Robot>
bool PathGraph<Robot>::find_shorter(MotionChecker<Robot>& checker, const Deadline& deadline,
                                    double length_limit, Path<Robot>& out) SOPT_RT {
  if (nodes_.empty()) return false;
  queue_.clear();
  for (Node& node : nodes_) node.is_closed = false;
  nodes_[kStart].from_start = 0.0;
  close(kStart, -1, length_limit);
  while (!queue_.empty() && !nodes_[kGoal].is_closed && !deadline.expired()) {
    std::pop_heap(queue_.begin(), queue_.end(), is_later);
    const Candidate best = queue_.back();
    (void)queue_.try_resize(queue_.size() - 1);
    if (nodes_[best.to].is_closed) continue;
    if (are_neighbors(best.from, best.to) ||
        checker.is_clear(nodes_[best.from].config, end_of(best.from), nodes_[best.to].config,
                         end_of(best.to))) {
      close(best.to, best.from, length_limit);
    }
  }
  return nodes_[kGoal].is_closed && store(out);
}

template <class Robot>
bool PathGraph<Robot>::store(Path<Robot>& out) const SOPT_RT {
  int num_vertices = 0;
  for (int i = kGoal; i >= 0; i = nodes_[i].parent) ++num_vertices;
  if (!out.vertices.try_resize(num_vertices)) return false;
  for (int i = kGoal; i >= 0; i = nodes_[i].parent) out.vertices[--num_vertices] = nodes_[i].config;
  out.unwrap(*robot_);
  return true;
}

template class PathGraph<Point2>;
template class PathGraph<Arm<4>>;
template class PathGraph<Arm<5>>;
template class PathGraph<Arm<6>>;
template class PathGraph<Arm<7>>;
template class PathGraph<Arm<8>>;

}  // namespace sopt
