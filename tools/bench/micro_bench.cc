// Cost of the pieces a plan is made of, on generated scenes: distance, edge test and broad phase
// against the number of obstacles, neighbour scan against the size of the tree, one window's QP.
// micro_bench_space.cc has those of space.
// usage: sopt_micro_bench [options of google-benchmark]
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "alloc/memory_block.h"
#include "models/plane/clearance2.h"
#include "models/plane/point2.h"
#include "models/plane/world2.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/point_rows.h"
#include "sampler/rng.h"
#include "sampler/tree.h"

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

}  // namespace
}  // namespace sopt

BENCHMARK_MAIN();
