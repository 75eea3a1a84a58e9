#include "tools/tables/tables_figures.h"

#include <algorithm>
#include <cstddef>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr std::size_t kNumPlans = 4;
constexpr double kBudget_s = 1.0;

// Those with the most obstacles; of equals, the first ones.
std::vector<Scene> pick_scenes(const std::vector<std::filesystem::path>& files) {
  std::vector<Scene> scenes;
  for (const std::filesystem::path& file : files) scenes.push_back(load_scene(file));
  std::stable_sort(scenes.begin(), scenes.end(), [](const Scene& a, const Scene& b) {
    return a.world->num_obstacles() > b.world->num_obstacles();
  });
  scenes.resize(std::min(scenes.size(), kNumPlans));
  return scenes;
}

}  // namespace

std::vector<std::string> figure_names(std::size_t num_scenes) {
  std::vector<std::string> names = {"concept.svg", "merging.svg", "segments.svg"};
  for (std::size_t i = 1; i <= std::min(num_scenes, kNumPlans); ++i) {
    names.push_back(format("plan_%zu.svg", i));
  }
  return names;
}

std::vector<TableFigure> draw_figures(const std::vector<std::filesystem::path>& files) {
  const std::vector<Scene> scenes = pick_scenes(files);
  std::vector<LineChart> concepts;
  std::vector<std::string> plans;
  for (const Scene& scene : scenes) {
    concepts.push_back(concept_chart(scene, kBudget_s));
    plans.push_back(draw_plan(scene));
  }
  std::vector<std::string> documents = {draw(concepts, 2), draw(merging_charts(scenes.front()), 3),
                                        draw_segmentations(scenes.front())};
  documents.insert(documents.end(), plans.begin(), plans.end());

  std::vector<TableFigure> figures;
  const std::vector<std::string> names = figure_names(scenes.size());
  for (std::size_t i = 0; i < names.size(); ++i) figures.push_back({names[i], documents[i]});
  return figures;
}

}  // namespace sopt
