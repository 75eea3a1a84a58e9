// Cost of the pieces a plan is made of, on generated scenes: distance, edge test and broad phase
// against the number of obstacles, neighbour scan against the size of the tree, one window's QP. Of
// arms, from the project's root: random configurations in the shipped scenes of 7 to 9 obstacles.
// usage: sopt_micro_bench [options of google-benchmark]
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "alloc/memory_block.h"
#include "models/arm/arm_clearance.h"
#include "models/arm/arm_lanes.h"
#include "models/arm/arm_motion.h"
#include "models/plane/clearance2.h"
#include "models/plane/point2.h"
#include "models/plane/world2.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/point_rows.h"
#include "sampler/rng.h"
#include "sampler/tree.h"
#include "tools/io/arm_scene.h"

namespace sopt {
namespace {

constexpr std::size_t kNumInputs = 1024;  // power of two: cycled through with a mask

struct Edge {
  Vec2 p, q;
};

// A square world with the density of the shipped scenes: one obstacle of about 2 m per 50 m^2.
class BenchWorld {
 public:
  explicit BenchWorld(int num_obstacles)
      : block_(World2::required_bytes(WorldCapacity{})),
        arena_(block_),
        world_(arena_, WorldCapacity{}) {
    const double width_m = std::sqrt(50.0 * num_obstacles);
    (void)world_.reset({Vec2::Zero(), Vec2::Constant(width_m)});
    for (int i = 0; i < num_obstacles; ++i) {
      const Vec2 center = width_m * point();
      const double size_m = 1.0 + rng_.next_uniform();
      if (i % 2 == 0) {
        (void)world_.try_add(Disc{center, 0.5 * size_m});
      } else {
        (void)world_.try_add(Box2{center, {size_m, 2.0}, rng_.next_uniform()});
      }
    }
    world_.build();
    for (Edge& edge : edges_) {
      edge.p = width_m * point();
      edge.q = edge.p + 3.0 * (2.0 * point() - Vec2::Ones());
    }
  }

  [[nodiscard]] const World2& world() const { return world_; }
  [[nodiscard]] const Edge& edge(std::size_t i) const { return edges_[i % kNumInputs]; }

 private:
  Vec2 point() { return {rng_.next_uniform(), rng_.next_uniform()}; }

  CounterRng rng_{1};
  MemoryBlock block_;
  Arena arena_;
  World2 world_;
  std::array<Edge, kNumInputs> edges_;
};

void edge_test(benchmark::State& state) {
  const BenchWorld bench(static_cast<int>(state.range(0)));
  const ClearanceRule rule{.margin_m = 0.05};
  std::size_t i = 0;
  for (auto _ : state) {
    const Edge& edge = bench.edge(i++);
    benchmark::DoNotOptimize(bench.world().is_clear(edge.p, edge.q, 0.1, rule));
  }
}
BENCHMARK(edge_test)->Arg(5)->Arg(20)->Arg(100)->Arg(1000)->Arg(5000);

void segment_clearance(benchmark::State& state) {
  const BenchWorld bench(64);
  std::size_t i = 0;
  for (auto _ : state) {
    const Edge& edge = bench.edge(i);
    benchmark::DoNotOptimize(
        compute_clearance(bench.world().obstacle(static_cast<int>(i++ % 64)), edge.p, edge.q));
  }
}
BENCHMARK(segment_clearance);

void world_build(benchmark::State& state) {
  BenchWorld bench(static_cast<int>(state.range(0)));
  auto& world = const_cast<World2&>(bench.world());  // owned by `bench`, which is not const
  for (auto _ : state) world.build();
}
BENCHMARK(world_build)->Arg(20)->Arg(5000);

void neighbor_scan(benchmark::State& state) {
  const int num_nodes = static_cast<int>(state.range(0));
  Arena measure = Arena::measuring();
  const Tree<Point2> measured(measure, num_nodes);
  const MemoryBlock block(measure.used_B());
  Arena arena(block);
  Tree<Point2> tree(arena, num_nodes);
  CounterRng rng(2);
  tree.reset(Point2{}, Vec2(0.5, 0.5));
  while (!tree.full()) (void)tree.try_add({rng.next_uniform(), rng.next_uniform()}, 0);
  const double radius = std::sqrt(std::log(num_nodes) / num_nodes);
  NearNodes near;
  for (auto _ : state) {
    tree.find_near({rng.next_uniform(), rng.next_uniform()}, radius, near);
    benchmark::DoNotOptimize(near);
  }
}
BENCHMARK(neighbor_scan)->Arg(16)->Arg(250)->Arg(1000)->Arg(10000);

// A straight string of n steps pushed aside by a disc of half its length.
void window_qp(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Arena measure = Arena::measuring();
  const PointRows measured_rows(measure, n, 8 * n);
  const ActiveSetQp<double> measured_qp(measure, 2 * n);
  const MemoryBlock block(measure.used_B());
  Arena arena(block);
  PointRows rows(arena, n, 8 * n);
  ActiveSetQp<double> qp(arena, 2 * n);
  for (auto _ : state) {
    rows.reset(n, Vec2(0.0, 0.0), Vec2(n, 0.0));
    for (int t = 1; t < n; ++t) {
      const Vec2 from_center = Vec2(t - 0.5 * n, 0.25 * n).normalized();
      (void)rows.try_add(t, from_center, from_center.x() * 0.5 * n + 0.25 * n);
    }
    benchmark::DoNotOptimize(qp.solve(rows, {}, Deadline{}));
  }
}
BENCHMARK(window_qp)->Arg(15)->Arg(30)->Arg(60);

// Shipped scenes, and configurations drawn between the limits.
class ArmBench {
 public:
  static constexpr int kDof = 5;
  using Config = Arm<kDof>::Config;

  ArmBench() {
    for (int i = 1; i <= 20; ++i) {
      const std::string file =
          "tools/scenes/arm/arm_8_" + std::to_string(100 + i).substr(1) + ".json";
      if (std::filesystem::exists(file)) scenes_.push_back(load_any_scene(file));
    }
    if (scenes_.empty()) return;
    CounterRng rng(3);
    const Arm<kDof>& arm = scene(0).arm;
    for (Config& q : configs_) {
      for (int j = 0; j < kDof; ++j) {
        q[j] = arm.lower()[j] + rng.next_uniform() * (arm.upper()[j] - arm.lower()[j]);
      }
    }
  }

  [[nodiscard]] bool is_present(benchmark::State& state) const {
    if (scenes_.empty()) state.SkipWithError("no tools/scenes/arm here");
    return !scenes_.empty();
  }
  [[nodiscard]] const ArmScene<kDof>& scene(std::size_t i) const {
    return std::get<ArmScene<kDof>>(scenes_[i % scenes_.size()]);
  }
  [[nodiscard]] const Config& config(std::size_t i) const { return configs_[i % kNumInputs]; }

 private:
  std::vector<AnyScene> scenes_;
  std::array<Config, kNumInputs> configs_;
};

ClearanceRule rule_of(const PlanOptions& options) {
  return {.margin_m = options.margin_m, .rung = 1.0, .floor_m = options.min_clearance_m};
}

void count_configurations(benchmark::State& state, int per_iteration, std::int64_t num_clear) {
  const double num = static_cast<double>(state.iterations()) * per_iteration;
  state.counters["configuration"] =
      benchmark::Counter(num, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["clear"] = static_cast<double>(num_clear) / num;
}

// Forward kinematics, obstacles and pairs of links.
void arm_exact(benchmark::State& state) {
  const ArmBench bench;
  if (!bench.is_present(state)) return;
  std::size_t i = 0;
  std::int64_t num_clear = 0;
  for (auto _ : state) {
    const auto& scene = bench.scene(i);
    ArmPose<ArmBench::kDof> pose;
    scene.arm.forward(bench.config(i++), pose);
    num_clear +=
        is_clear(scene.arm, *scene.world, pose, rule_of(scene.options), kSelfClearance_m) ? 1 : 0;
  }
  count_configurations(state, 1, num_clear);
}
BENCHMARK(arm_exact);

// Eight configurations that have nothing to do with each other, links' spheres first, then strict
// covers; obstacles only.
template <int N>
unsigned lanes_near(const ArmScene<N>& scene, const LaneConfig<N>& q, float pad_m) {
  const ClearanceRule rule = rule_of(scene.options);
  LanePose<N> pose;
  forward_lanes(scene.arm, q, pose);
  unsigned near = 0;
  const auto may_be_near = [&](int l, const CoverSphere& s) {
    const LaneFrame& X = pose.X_WJ[static_cast<std::size_t>(l)];
    const LaneVec3 c = X.position + turn(X, s.center[0], s.center[1], s.center[2]);
    return scene.world->lanes_near(SphereLanes{c.x, c.y, c.z, splat8(s.radius_m + pad_m)}, rule);
  };
  for (int l = 1; l <= N && near != kAllLanes; ++l) {
    const int first = scene.arm.first_capsule(l);
    const int last = scene.arm.first_capsule(l + 1);
    if (first == last) continue;
    const unsigned candidates = may_be_near(l, scene.arm.link_cover(l)) & ~near;
    if (candidates == 0) continue;
    for (int k = first; k < last; ++k) {
      for (const CoverSphere& s : scene.arm.cover(k)) near |= candidates & may_be_near(l, s);
    }
  }
  return near;
}

void arm_lanes(benchmark::State& state) {
  const ArmBench bench;
  if (!bench.is_present(state)) return;
  constexpr double kReach_m = 4.0;  // more than any point's of the arm
  const auto pad_m = static_cast<float>(lane_pad_m(bench.scene(0).arm, kReach_m, 0.0));
  std::size_t i = 0;
  std::int64_t num_clear = 0;
  for (auto _ : state) {
    const std::size_t first = i * kLanesFloat;
    LaneConfig<ArmBench::kDof> q;
    for (int j = 0; j < ArmBench::kDof; ++j) {
      LaneJoint& joint = q.joint[static_cast<std::size_t>(j)];
      for (std::size_t k = 0; k < kLanesDouble; ++k) {
        joint.low[k] = bench.config(first + k)[j];
        joint.high[k] = bench.config(first + kLanesDouble + k)[j];
      }
    }
    const unsigned near = lanes_near(bench.scene(i++), q, pad_m);
    num_clear += kLanesFloat - __builtin_popcount(near);
  }
  count_configurations(state, kLanesFloat, num_clear);
}
BENCHMARK(arm_lanes);

// What the sampler asks: a motion, here one so short that a single turn decides. Its eight middles
// are close together; exact where the lanes are not enough, pairs of links included.
void arm_motion(benchmark::State& state) {
  const ArmBench bench;
  if (!bench.is_present(state)) return;
  std::size_t i = 0;
  std::int64_t num_clear = 0;
  for (auto _ : state) {
    const auto& scene = bench.scene(i);
    const ArmBench::Config& q = bench.config(i++);
    const bool clear = motion_is_clear(scene.arm, *scene.world, rule_of(scene.options),
                                       kSelfClearance_m, q, q + ArmBench::Config::Constant(1e-5));
    num_clear += clear ? kLanesFloat : 0;
  }
  count_configurations(state, kLanesFloat, num_clear);
}
BENCHMARK(arm_motion);

}  // namespace
}  // namespace sopt

BENCHMARK_MAIN();
