// The defaults of the library, in one place. `PlannerSettings` and the capacities of worlds size
// memory at setup; `PlanOptions` travel with each request. Units are in the names; numbers that
// come from a measurement name it in docs/RESULTS.md.
#pragma once

#include <cstdint>

#include "models/capacity.h"

namespace sopt {

enum class SamplerMode : std::int8_t {
  kRrtStar,         // one tree from the start [Leu22, III-A]
  kRrtStarConnect,  // a tree from each end; Deviation: no heavy tail in the time to a path
};

// Which linearised obstacles a window keeps [Leu22, Alg. 2].
enum class RowMode : std::int8_t {
  kEdge,      // all near an edge, on both of its waypoints; Deviation: clear between waypoints too
  kWaypoint,  // all near a waypoint
  kLabelMap,  // the nearest one of each waypoint: what the paper's watershed labels
};

// How a window's QP is solved; the solution is the same.
enum class WindowSolver : std::int8_t {
  kClosedForm,  // Deviation: the inverse Hessian is known in closed form, opt/qp/point_rows.h
  kDense,       // condensed to the inputs and factorised in every window [Leu22, III-B]
};

enum class MergeRule : std::int8_t {
  kOff,
  kPaired,   // Deviation: keeps the parity of all other windows, see opt/splits.h
  kPrinted,  // [Leu22, Alg. 1 l.13]: the end that two windows share goes
  kEager,    // Deviation: kPaired, whatever the two gained, if both took their whole step
};

// What happens to the time axis as the path gets shorter.
enum class Resampling : std::int8_t {
  kOff,
  kScale,         // Deviation: dt shrinks once, at the end; exact
  kRediscretize,  // a new horizon after every sweep [Leu22, Alg. 1 l.16]
};

struct WorldCapacity {
  int max_obstacles = 8192;
  int max_vertices = 65536;  // of all obstacles together, each rounded up to a multiple of 4
};

struct World3Capacity {
  int max_obstacles = 1024;
  int max_hulls = 128;  // among them
};

// a_max / v_max of a joint where nobody says, 1/s: full speed after 0.2 s.
inline constexpr double kAccelerationPerVelocity = 5.0;

// Sizes the planner's memory; fixed for its life.
struct PlannerSettings {
  int max_horizon = 4096;            // steps of a trajectory, >= 2
  int num_streams = 4;               // sampler streams, 1..kMaxStreams
  int nodes_per_stream = 20000;      // both trees of a stream together, >= 4
  int max_path_vertices = 1024;      // of a sampled path, >= 4
  int max_lattice_points = 1 << 17;  // of the search that helps samples out; 0: none
  int max_window = 60;               // steps of one optimisation window, 4..kMaxWindow
  int rows_per_window = 512;         // obstacle rows of one window's QP, at least; >= 0
  bool dense_solver = false;         // room for WindowSolver::kDense

  [[nodiscard]] constexpr bool is_valid() const noexcept {
    return max_horizon >= 2 && num_streams >= 1 && num_streams <= kMaxStreams &&
           nodes_per_stream >= 4 && max_path_vertices >= 4 && max_lattice_points >= 0 &&
           max_window >= 4 && max_window <= kMaxWindow && rows_per_window >= 0;
  }
  // For arms.
  [[nodiscard]] static constexpr PlannerSettings arm() noexcept {
    PlannerSettings settings;
    settings.max_horizon = 1024;
    settings.nodes_per_stream = 8192;
    settings.max_window = 160;  // Deviation: eager merging ends at one window, which is best
    settings.rows_per_window = 768;
    return settings;
  }
  // The least that is valid.
  [[nodiscard]] static constexpr PlannerSettings smallest() noexcept {
    return {2, 1, 4, 4, 0, 4, 0};
  }
};

// What one request may ask for; 0 or a negative default says "derive it", as documented.
struct PlanOptions {
  // --- trajectory
  double speed_mps = 0.0;         // operating speed; 0: (bounds diagonal / 200, at most 4 r) / dt
  double dt_s = 0.1;              // step before time scaling
  double margin_m = 0.05;         // clearance wanted from obstacles and bounds
  double min_clearance_m = 1e-4;  // hard: verify rejects below it
  // --- sampler
  SamplerMode sampler = SamplerMode::kRrtStarConnect;
  int num_samples = 20000;  // per stream and batch, over all rungs of the margin ladder
  int num_batches = 4;      // batches before `no_path`
  int num_streams = 0;      // 0: as many as the settings have
  bool shortcut = true;
  bool lattice = true;  // search a lattice when the first round of samples finds no path
  // --- optimiser
  int num_segments = 0;       // 0: automatic, from the horizon
  int steps_per_window = 50;  // what the automatic number aims at (docs/segments.md)
  int max_window = 0;         // steps; 0: what the settings allow
  MergeRule merge = MergeRule::kPaired;
  Resampling resampling = Resampling::kScale;
  RowMode rows = RowMode::kEdge;
  WindowSolver solver = WindowSolver::kClosedForm;
  bool accept = true;             // take only steps that pass the window check
  bool zero_input_start = false;  // first sweep linearised about u = 0, as the paper begins
  double improve_s = 0.0;         // after the first plan, search for shorter ones this long; finite
  int max_iterations = 20;        // [Leu22, III-B termination (1)]
  double tol_step = 1e-3;         // cost per step, see opt/segmented_optimizer.h

  // For arms: speed_mps is in units of the path metric (rad/s), dt and margin are smaller.
  [[nodiscard]] static constexpr PlanOptions arm() noexcept {
    PlanOptions options;
    options.speed_mps = 1.0;
    options.dt_s = 0.05;
    options.margin_m = 0.02;
    options.num_batches = 48;  // the first ones give up early, see sampler/tuning.h
    options.num_streams = 2;   // more cost more than the optimiser gains from them
    options.merge = MergeRule::kEager;
    options.steps_per_window = 160;  // one window is best as long as it fits (docs/segments.md)
    options.tol_step = 4e-3;         // 2 % of cost for a quarter of the time (docs/RESULTS.md)
    return options;
  }

  // The choices of [Leu22], each of which can be made alone. Needs PlannerSettings::dense_solver.
  [[nodiscard]] static constexpr PlanOptions paper() noexcept {
    PlanOptions options;
    options.sampler = SamplerMode::kRrtStar;
    options.shortcut = false;
    options.lattice = false;
    options.steps_per_window = 30;
    options.merge = MergeRule::kPrinted;
    options.resampling = Resampling::kRediscretize;
    options.rows = RowMode::kLabelMap;
    options.solver = WindowSolver::kDense;
    options.accept = false;
    options.zero_input_start = true;
    return options;
  }
  // For arms. Deviation: a new horizon after every sweep would break a double integrator's
  // dynamics, and joint space has no label map: waypoints keep clear of everything near.
  [[nodiscard]] static constexpr PlanOptions paper_arm() noexcept {
    PlanOptions options = paper();
    options.resampling = Resampling::kOff;
    options.rows = RowMode::kWaypoint;
    return options;
  }
};

}  // namespace sopt
