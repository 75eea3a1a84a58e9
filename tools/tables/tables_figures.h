// The figures of [Leu22] made again, as SVG documents: the concept verification, what merging does
// to the cost; for the plane the first segmentations of a trajectory and four plans too. Taken from
// the scenes with the most obstacles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/io/arm_scene.h"
#include "tools/io/line_chart.h"

namespace sopt {

struct TableFigure {
  std::string name;  // of a file
  std::string svg;
};

// Of as many plans as `num_scenes` allow.
[[nodiscard]] std::vector<std::string> plane_figure_names(std::size_t num_scenes);
[[nodiscard]] std::vector<std::string> arm_figure_names();

// One for each name; there is at least one scene. Throws what load_scene or load_any_scene and
// TimedPlanner throw.
[[nodiscard]] std::vector<TableFigure> draw_plane_figures(
    const std::vector<std::filesystem::path>& scenes);
[[nodiscard]] std::vector<TableFigure> draw_arm_figures(
    const std::vector<std::filesystem::path>& scenes);

// Path length over thread CPU time: RRT* alone for `budget_s`, and RRT*-sOpt. The sampler stops at
// its first solution, so RRT* alone begins anew with the next seed and keeps its shortest.
[[nodiscard]] LineChart concept_chart(const AnyScene& scene, double budget_s);

// Cost from one sampled path on, over sweeps and over time with either QP: few segments, many, and
// many that merge.
[[nodiscard]] std::vector<LineChart> merging_charts(const AnyScene& scene);

// A sampled trajectory with its splits, then its first three sweeps.
[[nodiscard]] std::string draw_segmentations(const Scene& scene);

// As `sopt plan --svg` does.
[[nodiscard]] std::string draw_plan(const Scene& scene);

}  // namespace sopt
