#include "tools/io/scene_fields.h"

#include <algorithm>
#include <map>

#include "models/margin.h"
#include "models/world_status.h"

namespace sopt {

bool is_documentary(std::string_view name) {
  return name.starts_with("reference_") || name.starts_with("x_");
}

bool is_documentary_in_scene(std::string_view name) {
  constexpr std::string_view kIgnored[] = {"source",  "license",    "notes",
                                           "units",   "check",      "num_obstacles",
                                           "derived", "start_note", "tags"};
  return is_documentary(name) ||
         std::find(std::begin(kIgnored), std::end(kIgnored), name) != std::end(kIgnored);
}

std::string read_scene_name(const JsonField& root, const std::string& stem) {
  const std::optional<JsonField> name = root.find("name");
  return name ? name->text() : valid_utf8(stem);
}

std::vector<std::string> read_ids(const JsonField& obstacles) {
  std::map<std::string, std::size_t> first_with_id;
  std::vector<std::string> ids(obstacles.size());
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const std::optional<JsonField> id = obstacles[i].find("id");
    if (!id) continue;
    ids[i] = id->text();
    const auto [it, is_new] = first_with_id.try_emplace(ids[i], i);
    if (!is_new) id->fail("unique, obstacles[" + std::to_string(it->second) + "] has it already");
  }
  return ids;
}

double read_margin(const JsonField& obstacle) {
  return obstacle.find_number("margin", kNotNegative).value_or(kDefaultMargin);
}

void check_zeros(const JsonField& object, const char* name, std::size_t size,
                 std::string_view allowed) {
  const std::optional<JsonField> field = object.find(name);
  if (!field) return;
  const nlohmann::json& value = field->value();
  const bool is_zero = value.is_array() && value.size() == size &&
                       std::all_of(value.begin(), value.end(), [](const nlohmann::json& e) {
                         return e.is_number() && e.get<double>() == 0.0;
                       });
  if (!is_zero) field->fail(allowed);
}

void check_margins(const JsonField& root, const PlanOptions& options) {
  if (options.margin_m >= options.min_clearance_m) return;
  if (const std::optional<JsonField> margin = root.find("margin")) {
    margin->fail("at least min_clearance, " + show(options.min_clearance_m));
  }
  root.at("min_clearance", "").fail("at most margin, " + show(options.margin_m));
}

Vec3 read_three(const JsonField& field, const NumberRule& rule, std::string_view allowed) {
  field.check_array(3, 3, allowed);
  return {field[0].number(rule), field[1].number(rule), field[2].number(rule)};
}

std::string obstacle_name(const std::vector<std::string>& ids, int i_obstacle) {
  if (i_obstacle == kBoundsObstacle) return "the bounds";
  if (i_obstacle < 0) return "nothing";
  const std::string& id = ids[static_cast<std::size_t>(i_obstacle)];
  return "obstacle " + (id.empty() ? std::to_string(i_obstacle) : in_quotes(id));
}

}  // namespace sopt
