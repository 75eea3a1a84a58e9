// The figures of [Leu22] made again, as SVG documents: the concept verification, what merging does
// to the cost, the first segmentations of a trajectory, four plans. Taken from the scenes with the
// most obstacles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/io/line_chart.h"
#include "tools/io/scene_file.h"

namespace sopt {

struct TableFigure {
  std::string name;  // of a file
  std::string svg;
};

// Of as many plans as `num_scenes` allow.
[[nodiscard]] std::vector<std::string> figure_names(std::size_t num_scenes);

// One for each name. Throws what load_scene and TimedPlanner throw.
[[nodiscard]] std::vector<TableFigure> draw_figures(
    const std::vector<std::filesystem::path>& scenes);

// Path length over thread CPU time: RRT* alone for `budget_s`, and RRT*-sOpt. The sampler stops at
// its first solution, so RRT* alone begins anew with the next seed and keeps its shortest.
[[nodiscard]] LineChart concept_chart(const Scene& scene, double budget_s);

// Cost from one sampled path on, over sweeps and over time with either QP: few segments, many, and
// many that merge.
[[nodiscard]] std::vector<LineChart> merging_charts(const Scene& scene);

// A sampled trajectory with its splits, then its first three sweeps.
[[nodiscard]] std::string draw_segmentations(const Scene& scene);

// As `sopt plan --svg` does.
[[nodiscard]] std::string draw_plan(const Scene& scene);

}  // namespace sopt
