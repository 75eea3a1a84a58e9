// What sampler and optimiser tests share: objects with their own arena, an executor that runs tasks
// in an unusual order, scenes with obstacles around a known clear polyline, and independent answers
// about polylines (clearance against a margin profile by the oracle's dense sampling, cost,
// length). Units m, world frame. Slow, for tests only.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/margin.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/executor.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

// A T made by T(arena, args...) together with exactly the memory it takes.
template <class T>
class InArena {
 public:
  template <class... Args>
  explicit InArena(Args&&... args)
      : block_(measure(args...)), arena_(block_), object_(arena_, std::forward<Args>(args)...) {}

  T* operator->() { return &object_; }
  T& operator*() { return object_; }
  [[nodiscard]] bool exhausted() const { return arena_.exhausted(); }

 private:
  template <class... Args>
  static std::size_t measure(Args&&... args) {
    Arena arena = Arena::measuring();
    const T object(arena, args...);
    return arena.used_B();
  }

  MemoryBlock block_;
  Arena arena_;
  T object_;
};

// Last task first, worker after worker; still one thread.
class ReverseExecutor final : public Executor {
 public:
  explicit ReverseExecutor(int num_workers = 3) : num_workers_(num_workers) {}
  [[nodiscard]] int num_workers() const noexcept override { return num_workers_; }
  void run(Task task, int num_tasks) SOPT_RT override {
    for (int i = num_tasks - 1; i >= 0; --i) task(i % num_workers_, i);
  }

 private:
  int num_workers_;
};

struct TestPath {
  explicit TestPath(const std::vector<Vec2>& vertices, int max_vertices = 256)
      : memory(max_vertices), path(*memory) {
    for (const Vec2& z : vertices) (void)path.vertices.try_push_back(z);
  }

  InArena<Path<Point2>> memory;
  Path<Point2>& path;
};

[[nodiscard]] std::vector<Vec2> copy_of(std::span<const Vec2> points);
[[nodiscard]] bool same_bytes(std::span<const Vec2> a, std::span<const Vec2> b);
[[nodiscard]] std::string to_text(std::span<const Vec2> points);

[[nodiscard]] double length_of(std::span<const Vec2> points);
// sum |dz|^2 / ds
[[nodiscard]] double cost_of(std::span<const Vec2> points, double ds_m);

// The rule everywhere, no relaxed ends.
[[nodiscard]] MarginProfile plain_profile(double margin_m, double floor_m = 1e-4);

// Clearances of a scene, with what the brute force needs prepared once.
class SceneOracle {
 public:
  explicit SceneOracle(const Scene& scene);

  // Smallest clearance of a disc along the motion from p to q.
  [[nodiscard]] double clearance(const Vec2& p, const Vec2& q, double radius_m) const;
  // Smallest of clearance minus what `rule` asks for, over obstacles and walls; >= 0 is clear.
  [[nodiscard]] double slack(const Vec2& p, const Vec2& q, double radius_m,
                             const ClearanceRule& rule) const;
  // Of a path, whose first and last motion may use the profile's relaxed rules near the ends.
  [[nodiscard]] double path_slack(std::span<const Vec2> vertices, double radius_m,
                                  const MarginProfile& profile) const;
  // Of a trajectory, whose steps each have a rule.
  [[nodiscard]] double trajectory_slack(std::span<const Vec2> states, double radius_m,
                                        const MarginProfile& profile) const;
  // Of a trajectory against one clearance for everything.
  [[nodiscard]] double min_clearance(std::span<const Vec2> states, double radius_m) const;

 private:
  struct Item {
    Outline outline;
    Vec2 center = Vec2::Zero();  // of a circle around the outline
    double reach_m = 0.0;
    double margin_m = kDefaultMargin;
  };

  Aabb2 bounds_;
  std::vector<Item> items_;
};

// Cuts every motion into equal steps of at most step_m; at least two steps.
[[nodiscard]] std::vector<Vec2> cut_into_steps(std::span<const Vec2> vertices, double step_m);

[[nodiscard]] std::vector<Vec2> random_polyline(Random& random, const Aabb2& box, int num_vertices);

// Random obstacles that leave `keep_m` around the polyline, up to `num_tries` of them.
[[nodiscard]] Scene random_scene_around(Random& random, const Aabb2& bounds,
                                        std::span<const Vec2> polyline, int num_tries,
                                        double size_m, double keep_m);

// A room of 10 m x 6 m cut by a wall at x = 5 with a gap of the given width at its middle.
[[nodiscard]] Scene room_with_gap(double gap_m);

// Two walls of many short boxes along x, the given width apart, about y = 3; and waypoints from
// (1, 3) to (9, 3) between them that go up and down by amplitude_m at every step.
[[nodiscard]] Scene narrow_corridor(double width_m);
[[nodiscard]] std::vector<Vec2> zigzag_in_corridor(double step_m, double amplitude_m);

}  // namespace sopt::oracle
