// The QPs that plans in the plane pose: reference, splits, obstacle rows and window optimiser are
// the planner's own, in its order, and every window's QP is kept before the window is optimised.
// Sweeps do not stop early and windows are neither merged nor cut, so that each of them comes back
// two sweeps later: as the QP that a warm start is for. Positions are in m, input is the step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "models/plane/point2.h"
#include "opt/splits.h"
#include "tools/io/scene_file.h"
#include "tools/qp/qp_families.h"

namespace sopt {

inline constexpr char kRecordedFamily = 'p';

struct RecordedQp {
  int sweep = 0;  // from 1
  Window window;
  SegmentQp problem;
  std::vector<Vec2> reference;  // of the window, num_steps + 1 points
};

// In the order in which they are solved: windows of at least 2 steps with rows, all of which hold
// at the reference, to 2e-9 m. Next to an end of the plan rows may not, and the planner asks for
// less there; such windows are left out. `seed` is the sampler's. Throws InputError when there is
// no plan, and what PlannerHost throws.
[[nodiscard]] std::vector<RecordedQp> record_qps(const Scene& scene, std::uint64_t seed);

// For every row of `cold` the row of `warm` at the same time whose normal is nearest, if that is
// within 0.2 rad and nearest to each other; -1: none.
[[nodiscard]] std::vector<int> match_rows(const KernelPart<double>& cold,
                                          const KernelPart<double>& warm);

// Every window with its successor two sweeps later. Throws what load_scene and record_qps throw.
[[nodiscard]] QpFamily make_recorded_family(const std::vector<std::filesystem::path>& scenes,
                                            std::uint64_t seed);

}  // namespace sopt
