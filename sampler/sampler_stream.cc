#include "sampler/sampler_stream.h"

#include <algorithm>
#include <cmath>

#include "models/plane/point2.h"
#include "sampler/tuning.h"

namespace sopt {
namespace {

// Measure of the unit ball in `dof` dimensions.
double unit_ball_volume(int dof) noexcept {
  constexpr double kPi = 3.14159265358979323846;
  return std::pow(kPi, 0.5 * dof) / std::tgamma(0.5 * dof + 1.0);
}

}  // namespace

template <class Robot>
SamplerStream<Robot>::SamplerStream(Arena& arena, const PlannerSettings& settings) noexcept
    : trees_{Tree<Robot>(arena, settings.nodes_per_stream / 2),
             Tree<Robot>(arena, settings.nodes_per_stream / 2)},
      path_(arena, settings.max_path_vertices) {}

template <class Robot>
void SamplerStream<Robot>::reset(const StreamProblem<Robot>& problem,
                                 const CounterRng& rng) SOPT_RT {
  problem_ = problem;
  rng_ = rng;
  trees_[kStartTree].reset(*problem.robot, problem.start);
  trees_[kGoalTree].reset(*problem.robot, problem.goal);
  path_.vertices.clear();
  path_overflow_ = false;
  num_checks_ = 0;
  next_tree_ = kStartTree;
  num_blocked_.fill(0);
  const auto box = problem.robot->sampling_box(*problem.world, problem.profile.rule);
  box_lower_ = box.lower;
  box_size_ = (box.upper - box.lower).cwiseMax(0.0);
  const Config metric_size = problem.robot->weights().cwiseProduct(box_size_);
  range_ = SamplerTuning<Robot>::kRangeShare * metric_size.norm();
  const double d = Robot::kDof;
  radius_scale_ =
      2.0 * std::pow((1.0 + 1.0 / d) * metric_size.prod() / unit_ball_volume(Robot::kDof), 1.0 / d);
}

template <class Robot>
void SamplerStream<Robot>::run(int num_samples, const Deadline& deadline) SOPT_RT {
  Checker checker(*problem_.robot, *problem_.world, problem_.profile);
  const bool connect = problem_.mode == SamplerMode::kRrtStarConnect;
  if (trees_[kStartTree].size() == 1) {
    connect ? try_connect(checker, kStartTree, 0) : try_goal(checker, 0);
  }
  for (int i = 0; i < num_samples && !has_path() && !exhausted() && !deadline.expired(); ++i) {
    const std::size_t i_tree = connect ? next_tree_ : kStartTree;
    next_tree_ = 1 - next_tree_;
    const int node = extend(checker, i_tree, sample());
    if (node == kNoNode) continue;
    connect ? try_connect(checker, i_tree, node) : try_goal(checker, node);
  }
  num_checks_ += checker.num_checks();
}

template <class Robot>
typename Robot::Config SamplerStream<Robot>::sample() SOPT_RT {
  Config q;
  for (int i = 0; i < kInformedTries; ++i) {
    for (int dof = 0; dof < Robot::kDof; ++dof) {
      q[dof] = box_lower_[dof] + box_size_[dof] * rng_.next_uniform();
    }
    const double through = problem_.robot->path_distance(problem_.start, q) +
                           problem_.robot->path_distance(q, problem_.goal);
    if (through < problem_.max_length) break;
  }
  return q;
}

template <class Robot>
typename Robot::Config SamplerStream<Robot>::steer(const Config& from,
                                                   const Config& to) const SOPT_RT {
  const double distance = problem_.robot->path_distance(from, to);
  return distance <= range_ ? to : problem_.robot->interpolate(from, to, range_ / distance);
}

template <class Robot>
double SamplerStream<Robot>::rewire_radius(int num_nodes) const SOPT_RT {
  const double n = num_nodes + 1.0;
  return std::min(range_,
                  kRadiusShare * radius_scale_ * std::pow(std::log(n) / n, 1.0 / Robot::kDof));
}

template <class Robot>
bool SamplerStream<Robot>::motion_is_clear(Checker& checker, std::size_t i_tree, int from,
                                           const Config& to, RequestEnd to_end) SOPT_RT {
  const RequestEnd root_end = i_tree == kStartTree ? RequestEnd::kStart : RequestEnd::kGoal;
  const RequestEnd from_end = from == 0 ? root_end : RequestEnd::kNone;
  return checker.is_clear(trees_[i_tree].config(from), from_end, to, to_end);
}

// The nearest node has to see the new one; a neighbour that sees it too and is cheaper becomes the
// parent.
template <class Robot>
int SamplerStream<Robot>::extend(Checker& checker, std::size_t i_tree,
                                 const Config& target) SOPT_RT {
  using Tuning = SamplerTuning<Robot>;
  Tree<Robot>& tree = trees_[i_tree];
  tree.find_near(target, 0.0, near_);
  const int nearest = near_.nearest;
  const Config from = tree.config(nearest);
  const Config reached = steer(from, target);
  for (const double share : Tuning::kExtensionShares) {
    if (share < 1.0 && num_blocked_[i_tree] < Tuning::kBlockedInARow) break;
    const Config q = share == 1.0 ? reached : problem_.robot->interpolate(from, reached, share);
    if (!motion_is_clear(checker, i_tree, nearest, q, RequestEnd::kNone)) continue;
    tree.find_near(q, rewire_radius(tree.size()), near_);
    const int node = tree.try_add(q, best_parent(checker, i_tree, nearest, q));
    if (node != kNoNode) rewire_neighbors(checker, i_tree, node);
    num_blocked_[i_tree] = 0;
    return node;
  }
  ++num_blocked_[i_tree];
  return kNoNode;
}

template <class Robot>
int SamplerStream<Robot>::best_parent(Checker& checker, std::size_t i_tree, int nearest,
                                      const Config& q) SOPT_RT {
  const Tree<Robot>& tree = trees_[i_tree];
  const auto cost_through = [&](int node) {
    return tree.cost(node) + problem_.robot->path_distance(tree.config(node), q);
  };
  const double cost_limit = cost_through(nearest) * (1.0 - kRewireGain);
  std::array<double, kMaxNeighbors> cost{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(near_.count); ++i) {
    cost[i] = cost_through(near_.index[i]);
  }
  for (int tries = 0; tries < std::min(near_.count, kMaxParentTries); ++tries) {
    auto* const best = std::min_element(cost.begin(), cost.begin() + near_.count);
    if (*best >= cost_limit) break;
    const int candidate = near_.index[static_cast<std::size_t>(best - cost.begin())];
    if (motion_is_clear(checker, i_tree, candidate, q, RequestEnd::kNone)) return candidate;
    *best = std::numeric_limits<double>::infinity();
  }
  return nearest;
}

template <class Robot>
void SamplerStream<Robot>::rewire_neighbors(Checker& checker, std::size_t i_tree,
                                            int node) SOPT_RT {
  Tree<Robot>& tree = trees_[i_tree];
  const Config q = tree.config(node);
  for (std::size_t i = 0; i < static_cast<std::size_t>(near_.count); ++i) {
    const int neighbor = near_.index[i];
    if (neighbor == 0 || neighbor == tree.parent(node)) continue;
    const Config& at = tree.config(neighbor);
    const double through = tree.cost(node) + problem_.robot->path_distance(q, at);
    if (through >= tree.cost(neighbor) * (1.0 - kRewireGain)) continue;
    if (motion_is_clear(checker, i_tree, node, at, RequestEnd::kNone)) tree.rewire(neighbor, node);
  }
}

template <class Robot>
void SamplerStream<Robot>::try_goal(Checker& checker, int node) SOPT_RT {
  const Config& q = trees_[kStartTree].config(node);
  const bool is_root = node == 0;
  if (!is_root && problem_.robot->path_distance(q, problem_.goal) > range_) return;
  if (motion_is_clear(checker, kStartTree, node, problem_.goal, RequestEnd::kGoal)) {
    store_path(node, 0);
  }
}

// Grows the other tree from its node nearest to the new one, greedily, until it arrives or is
// blocked. A motion all the way is tried first.
template <class Robot>
void SamplerStream<Robot>::try_connect(Checker& checker, std::size_t i_tree, int node) SOPT_RT {
  const std::size_t i_other = 1 - i_tree;
  Tree<Robot>& other = trees_[i_other];
  const Config q = trees_[i_tree].config(node);
  const RequestEnd q_end = node != 0              ? RequestEnd::kNone
                           : i_tree == kStartTree ? RequestEnd::kStart
                                                  : RequestEnd::kGoal;
  other.find_near(q, 0.0, near_);
  int from = near_.nearest;
  for (int i_step = 0; i_step < kMaxConnectSteps && from != kNoNode; ++i_step) {
    if (motion_is_clear(checker, i_other, from, q, q_end)) {
      i_tree == kStartTree ? store_path(node, from) : store_path(from, node);
      return;
    }
    const Config next = steer(other.config(from), q);
    if (next == q || !motion_is_clear(checker, i_other, from, next, RequestEnd::kNone)) {
      if (i_step == 0) ++num_blocked_[i_other];
      return;
    }
    from = other.try_add(next, from);
    num_blocked_[i_other] = 0;
  }
}

template <class Robot>
void SamplerStream<Robot>::store_path(int start_node, int goal_node) SOPT_RT {
  auto& vertices = path_.vertices;
  vertices.clear();
  bool fits = true;
  for (int i = start_node; i != kNoNode && fits; i = trees_[kStartTree].parent(i)) {
    fits = vertices.try_push_back(trees_[kStartTree].config(i));
  }
  std::reverse(vertices.begin(), vertices.end());
  for (int i = goal_node; i != kNoNode && fits; i = trees_[kGoalTree].parent(i)) {
    fits = vertices.try_push_back(trees_[kGoalTree].config(i));
  }
  path_.unwrap(*problem_.robot);
  if (!fits) {
    vertices.clear();
    path_overflow_ = true;
  }
}

template <class Robot>
int SamplerStream<Robot>::num_nodes() const SOPT_RT {
  return trees_[kStartTree].size() + trees_[kGoalTree].size();
}

template <class Robot>
const typename Robot::Config& SamplerStream<Robot>::node(int i) const SOPT_RT {
  const int num_start = trees_[kStartTree].size();
  return i < num_start ? trees_[kStartTree].config(i) : trees_[kGoalTree].config(i - num_start);
}

template <class Robot>
int SamplerStream<Robot>::parent(int i) const SOPT_RT {
  const int num_start = trees_[kStartTree].size();
  if (i < num_start) return trees_[kStartTree].parent(i);
  const int above = trees_[kGoalTree].parent(i - num_start);
  return above == kNoNode ? kNoNode : above + num_start;
}

template class SamplerStream<Point2>;
template class SamplerStream<Arm<4>>;
template class SamplerStream<Arm<5>>;
template class SamplerStream<Arm<6>>;
template class SamplerStream<Arm<7>>;
template class SamplerStream<Arm<8>>;

}  // namespace sopt
