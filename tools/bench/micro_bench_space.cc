// Cost of the pieces of a plan in space: the distance of two shapes, and, from the project's root,
// random configurations of an arm in the shipped scenes of 7 to 9 obstacles.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "models/arm/arm_clearance.h"
#include "models/arm/arm_lanes.h"
#include "models/arm/arm_motion.h"
#include "models/space/clearance3.h"
#include "sampler/rng.h"
#include "tools/io/arm_scene.h"

namespace sopt {
namespace {

constexpr std::size_t kNumInputs = 1024;  // power of two: cycled through with a mask

// Pairs of shapes 0.1 to 0.5 m large, any way round, at most 1 m apart: either all apart or all
// overlapping.
class PairBench {
 public:
  PairBench(CoreKind obstacle, CoreKind body, bool apart) {
    for (int i = 0; i < kHullCorners; ++i) {
      corners_[static_cast<std::size_t>(i)] = 0.2 * (vector() - Vec3::Constant(0.5));
    }
    (void)try_make_convex(Hull3{corners_}, hull_, hull_shape_);
    for (Pair& pair : pairs_) {
      do {
        pair.obstacle = shape(obstacle, Vec3::Zero());
        pair.body = shape(body, 2.0 * (vector() - Vec3::Constant(0.5)));
      } while (is_within(pair.obstacle, pair.body, 0.0) == apart || distance_m(pair) > 1.0);
    }
  }

  [[nodiscard]] Clearance3 clearance(std::size_t i) const {
    const Pair& pair = pairs_[i & (kNumInputs - 1)];
    return compute_clearance(pair.obstacle, pair.body);
  }

 private:
  static constexpr int kHullCorners = 12;
  struct Pair {
    Convex3 obstacle, body;
  };

  [[nodiscard]] static double distance_m(const Pair& pair) {
    return compute_clearance(pair.obstacle, pair.body).distance_m;
  }
  [[nodiscard]] Vec3 vector() {
    return {rng_.next_uniform(), rng_.next_uniform(), rng_.next_uniform()};
  }
  [[nodiscard]] Convex3 shape(CoreKind kind, const Vec3& center) {
    const Eigen::Quaterniond turn(rng_.next_uniform() - 0.5, rng_.next_uniform() - 0.5,
                                  rng_.next_uniform() - 0.5, rng_.next_uniform() - 0.5);
    const Mat3 rotation = turn.normalized().toRotationMatrix();
    const Vec3 half = 0.05 * Vec3::Ones() + 0.2 * vector();
    if (kind == CoreKind::kSegment) {
      const Vec3 end = rotation.col(2) * half.z();
      return to_convex({center - end, center + end, 0.4 * half.x()});
    }
    Convex3 out = kind == CoreKind::kHull ? hull_shape_ : Convex3{};
    out.kind = kind;
    out.center = center;
    if (kind != CoreKind::kHull) out.axes = rotation;  // hulls stand as they are
    if (kind == CoreKind::kCylinder) out.half_m = {half.x(), half.x(), half.z()};
    if (kind == CoreKind::kBox) out.half_m = half;
    return out;
  }

  CounterRng rng_{4};
  std::array<Vec3, kHullCorners> corners_;
  HullData hull_;
  Convex3 hull_shape_;
  std::array<Pair, kNumInputs> pairs_;
};

void space_clearance(benchmark::State& state, CoreKind obstacle, CoreKind body, bool apart) {
  const PairBench bench(obstacle, body, apart);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(bench.clearance(i++));
}
BENCHMARK_CAPTURE(space_clearance, box_capsule_apart, CoreKind::kBox, CoreKind::kSegment, true);
BENCHMARK_CAPTURE(space_clearance, box_capsule_overlap, CoreKind::kBox, CoreKind::kSegment, false);
BENCHMARK_CAPTURE(space_clearance, box_box_apart, CoreKind::kBox, CoreKind::kBox, true);
BENCHMARK_CAPTURE(space_clearance, box_box_overlap, CoreKind::kBox, CoreKind::kBox, false);
BENCHMARK_CAPTURE(space_clearance, cylinder_capsule_apart, CoreKind::kCylinder, CoreKind::kSegment,
                  true);
BENCHMARK_CAPTURE(space_clearance, hull_capsule_apart, CoreKind::kHull, CoreKind::kSegment, true);

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
unsigned lanes_near(const ArmScene<N>& scene, const LaneConfig<N>& q, float pad_m,
                    LanePose<N>& pose) {
  const ClearanceRule rule = rule_of(scene.options);
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
  LaneConfig<ArmBench::kDof> q{};
  LanePose<ArmBench::kDof> pose{};  // set by every call
  std::size_t i = 0;
  std::int64_t num_clear = 0;
  for (auto _ : state) {
    const std::size_t first = i * kLanesFloat;
    for (int j = 0; j < ArmBench::kDof; ++j) {
      LaneJoint& joint = q.joint[static_cast<std::size_t>(j)];
      for (std::size_t k = 0; k < kLanesDouble; ++k) {
        joint.low[k] = bench.config(first + k)[j];
        joint.high[k] = bench.config(first + kLanesDouble + k)[j];
      }
    }
    const unsigned near = lanes_near(bench.scene(i++), q, pad_m, pose);
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
