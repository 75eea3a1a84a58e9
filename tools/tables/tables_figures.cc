#include "tools/tables/tables_figures.h"

#include <algorithm>
#include <cstddef>
#include <variant>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr std::size_t kNumScenes = 4;
constexpr double kBudget_s = 1.0;

int num_obstacles(const AnyScene& scene) {
  return std::visit([](const auto& typed) { return typed.world->num_obstacles(); }, scene);
}

// Those with the most obstacles; of equals, the first ones.
std::vector<AnyScene> pick_scenes(const std::vector<std::filesystem::path>& files) {
  std::vector<AnyScene> scenes;
  for (const std::filesystem::path& file : files) scenes.push_back(load_any_scene(file));
  std::stable_sort(scenes.begin(), scenes.end(), [](const AnyScene& a, const AnyScene& b) {
    return num_obstacles(a) > num_obstacles(b);
  });
  scenes.erase(scenes.begin() + static_cast<std::ptrdiff_t>(std::min(scenes.size(), kNumScenes)),
               scenes.end());
  return scenes;
}

std::vector<std::string> draw_charts(const std::vector<AnyScene>& scenes) {
  std::vector<LineChart> concepts;
  for (const AnyScene& scene : scenes) concepts.push_back(concept_chart(scene, kBudget_s));
  return {draw(concepts, 2), draw(merging_charts(scenes.front()), 3)};
}

std::vector<TableFigure> name_figures(const std::vector<std::string>& names,
                                      const std::vector<std::string>& documents) {
  std::vector<TableFigure> figures;
  for (std::size_t i = 0; i < names.size(); ++i) figures.push_back({names[i], documents[i]});
  return figures;
}

}  // namespace

std::vector<std::string> plane_figure_names(std::size_t num_scenes) {
  std::vector<std::string> names = {"concept.svg", "merging.svg", "segments.svg"};
  for (std::size_t i = 1; i <= std::min(num_scenes, kNumScenes); ++i) {
    names.push_back(format("plan_%zu.svg", i));
  }
  return names;
}

std::vector<std::string> arm_figure_names() { return {"concept_arm.svg", "merging_arm.svg"}; }

std::vector<TableFigure> draw_plane_figures(const std::vector<std::filesystem::path>& files) {
  const std::vector<AnyScene> scenes = pick_scenes(files);
  std::vector<std::string> documents = draw_charts(scenes);
  documents.push_back(draw_segmentations(std::get<Scene>(scenes.front())));
  for (const AnyScene& scene : scenes) documents.push_back(draw_plan(std::get<Scene>(scene)));
  return name_figures(plane_figure_names(scenes.size()), documents);
}

std::vector<TableFigure> draw_arm_figures(const std::vector<std::filesystem::path>& files) {
  return name_figures(arm_figure_names(), draw_charts(pick_scenes(files)));
}

}  // namespace sopt
