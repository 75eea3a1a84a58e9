#include "tools/cli/algorithm_options.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "models/arm/arm.h"

namespace sopt {
namespace {

struct Parsed {
  AlgorithmOptions options;
  PlanOptions plan;
};

// Throws CLI::ParseError on wrong usage. `scene` stands for what the scene says.
Parsed parse(const std::vector<std::string>& arguments, const PlanOptions& scene = {}) {
  CLI::App app("test");
  Parsed parsed;
  add_algorithm_options(app, parsed.options);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  parsed.plan = scene;
  apply(parsed.options, parsed.plan);
  return parsed;
}

PlanOptions plan_of(const std::vector<std::string>& arguments, const PlanOptions& scene = {}) {
  return parse(arguments, scene).plan;
}

nlohmann::ordered_json json_of(const std::vector<std::string>& arguments) {
  return to_json(parse(arguments).options);
}

void expect_same(const PlanOptions& a, const PlanOptions& b) {
  EXPECT_EQ(a.speed_mps, b.speed_mps);
  EXPECT_EQ(a.dt_s, b.dt_s);
  EXPECT_EQ(a.margin_m, b.margin_m);
  EXPECT_EQ(a.min_clearance_m, b.min_clearance_m);
  EXPECT_EQ(a.sampler, b.sampler);
  EXPECT_EQ(a.num_samples, b.num_samples);
  EXPECT_EQ(a.num_batches, b.num_batches);
  EXPECT_EQ(a.num_streams, b.num_streams);
  EXPECT_EQ(a.shortcut, b.shortcut);
  EXPECT_EQ(a.lattice, b.lattice);
  EXPECT_EQ(a.num_segments, b.num_segments);
  EXPECT_EQ(a.steps_per_window, b.steps_per_window);
  EXPECT_EQ(a.max_window, b.max_window);
  EXPECT_EQ(a.merge, b.merge);
  EXPECT_EQ(a.resampling, b.resampling);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.solver, b.solver);
  EXPECT_EQ(a.accept, b.accept);
  EXPECT_EQ(a.zero_input_start, b.zero_input_start);
  EXPECT_EQ(a.max_iterations, b.max_iterations);
  EXPECT_EQ(a.tol_step, b.tol_step);
}

PlanOptions scene_options() {
  PlanOptions scene;
  scene.speed_mps = 0.7;
  scene.dt_s = 0.2;
  scene.margin_m = 0.12;
  scene.min_clearance_m = 0.003;
  return scene;
}

TEST(AlgorithmOptions, ChangeNothingWhenNoneIsGiven) {
  expect_same(plan_of({}), PlanOptions());
  expect_same(plan_of({}, scene_options()), scene_options());
}

TEST(AlgorithmOptions, MakeOneChoiceEach) {
  const PlanOptions paper = PlanOptions::paper();
  PlanOptions expected;
  expected.sampler = paper.sampler;
  expect_same(plan_of({"--sampler", "rrt_star"}), expected);
  expected = {};
  expected.shortcut = paper.shortcut;
  expect_same(plan_of({"--no-shortcut"}), expected);
  expected = {};
  expected.lattice = paper.lattice;
  expect_same(plan_of({"--no-lattice"}), expected);
  expected = {};
  expected.rows = paper.rows;
  expect_same(plan_of({"--rows", "label_map"}), expected);
  expected.rows = RowMode::kWaypoint;
  expect_same(plan_of({"--rows", "waypoint"}), expected);
  expected = {};
  expected.solver = paper.solver;
  expect_same(plan_of({"--qp", "dense"}), expected);
  expected = {};
  expected.zero_input_start = paper.zero_input_start;
  expect_same(plan_of({"--start", "zero_input"}), expected);
  expected = {};
  expected.accept = paper.accept;
  expect_same(plan_of({"--no-accept"}), expected);
  expected = {};
  expected.merge = paper.merge;
  expect_same(plan_of({"--merge-rule", "printed"}), expected);
  expected.merge = MergeRule::kEager;
  expect_same(plan_of({"--merge-rule", "eager"}), expected);
  expected.merge = MergeRule::kOff;
  expect_same(plan_of({"--no-merge"}), expected);
  expected = {};
  expected.resampling = paper.resampling;
  expect_same(plan_of({"--resample", "rediscretise"}), expected);
  expected.resampling = Resampling::kOff;
  expect_same(plan_of({"--resample", "off"}), expected);
}

TEST(AlgorithmOptions, TakeAllOfThePapersChoicesAtOnce) {
  expect_same(plan_of({"--paper"}), PlanOptions::paper());
}

TEST(AlgorithmOptions, ThePapersChoicesForArmsLeaveOutWhatOnlyThePlaneHas) {
  AlgorithmOptions paper;
  paper.paper = true;
  PlanOptions plan = PlanOptions::arm();
  apply(paper, plan, paper_options<Arm<5>>());
  PlanOptions expected = PlanOptions::paper();
  expected.rows = RowMode::kWaypoint;
  expected.resampling = Resampling::kOff;
  expected.speed_mps = PlanOptions::arm().speed_mps;
  expected.num_batches = PlanOptions::arm().num_batches;
  expected.dt_s = PlanOptions::arm().dt_s;
  expected.margin_m = PlanOptions::arm().margin_m;
  expect_same(plan, expected);
  const auto report = to_json(AlgorithmOptions(), PlanOptions::arm(), paper_options<Arm<5>>());
  EXPECT_EQ(report["merge"], "eager");
}

TEST(AlgorithmOptions, LetTheSceneKeepItsTimesAndClearances) {
  PlanOptions expected = PlanOptions::paper();
  expected.speed_mps = 0.7;
  expected.dt_s = 0.2;
  expected.margin_m = 0.12;
  expected.min_clearance_m = 0.003;
  expect_same(plan_of({"--paper"}, scene_options()), expected);
}

TEST(AlgorithmOptions, WinOverThePaperInAnyOrder) {
  const std::vector<std::string> against = {
      "--sampler", "rrt_star_connect", "--rows",     "edge",  "--qp",         "kernel",
      "--start",   "reference",        "--resample", "scale", "--merge-rule", "paired"};
  PlanOptions expected;
  expected.shortcut = false;
  expected.lattice = false;
  expected.accept = false;
  expected.steps_per_window = 30;
  std::vector<std::string> arguments = against;
  arguments.push_back("--paper");
  expect_same(plan_of(arguments), expected);
  arguments = against;
  arguments.insert(arguments.begin(), "--paper");
  expect_same(plan_of(arguments), expected);
  EXPECT_EQ(plan_of({"--paper", "--no-merge"}).merge, MergeRule::kOff);
}

TEST(AlgorithmOptions, TakeNumbers) {
  PlanOptions expected;
  expected.num_samples = 500;
  expected.num_streams = 2;
  expected.num_segments = 7;
  expected.max_window = 33;
  expected.margin_m = 0.2;
  expected.speed_mps = 1.5;
  expected.dt_s = 0.05;
  const std::vector<std::string> arguments = {
      "--samples", "500",      "--streams", "2",       "--segments", "7",    "--max-window",
      "33",        "--margin", "0.2",       "--speed", "1.5",        "--dt", "0.05"};
  expect_same(plan_of(arguments), expected);
  // Over what the scene says, too.
  PlanOptions scene = scene_options();
  expected.min_clearance_m = scene.min_clearance_m;
  expect_same(plan_of(arguments, scene), expected);
}

TEST(AlgorithmOptions, RefuseWordsThatMeanNothing) {
  for (const char* option :
       {"--sampler", "--rows", "--qp", "--start", "--resample", "--merge-rule"}) {
    for (const char* word : {"", "of", "Edge", "dense ", "1"}) {
      EXPECT_THROW(parse({option, word}), CLI::ParseError) << option << " " << word;
    }
    EXPECT_THROW(parse({option}), CLI::ParseError) << option;
  }
  // Each has words of its own.
  EXPECT_THROW(parse({"--rows", "dense"}), CLI::ParseError);
  EXPECT_THROW(parse({"--merge-rule", "off"}), CLI::ParseError);
  EXPECT_THROW(parse({"--paper", "yes"}), CLI::ParseError);
}

TEST(AlgorithmOptions, ReportWhatTheyChoose) {
  const auto defaults = json_of({});
  EXPECT_EQ(defaults["sampler"], "rrt_star_connect");
  EXPECT_EQ(defaults["shortcut"], true);
  EXPECT_EQ(defaults["lattice"], true);
  EXPECT_EQ(defaults["rows"], "edge");
  EXPECT_EQ(defaults["qp"], "kernel");
  EXPECT_EQ(defaults["start"], "reference");
  EXPECT_EQ(defaults["accept"], true);
  EXPECT_EQ(defaults["merge"], "paired");
  EXPECT_EQ(defaults["resample"], "scale");
  EXPECT_EQ(defaults["segments"], "auto");
  for (const char* name : {"samples", "streams", "max_window", "margin", "speed", "dt"}) {
    EXPECT_TRUE(defaults.contains(name)) << name;
    EXPECT_TRUE(defaults[name].is_null()) << name;
  }
  const auto paper = json_of({"--paper"});
  EXPECT_EQ(paper["sampler"], "rrt_star");
  EXPECT_EQ(paper["shortcut"], false);
  EXPECT_EQ(paper["lattice"], false);
  EXPECT_EQ(paper["rows"], "label_map");
  EXPECT_EQ(paper["qp"], "dense");
  EXPECT_EQ(paper["start"], "zero_input");
  EXPECT_EQ(paper["accept"], false);
  EXPECT_EQ(paper["merge"], "printed");
  EXPECT_EQ(paper["resample"], "rediscretise");
}

// Everything that is not a number of the scene can be typed again.
TEST(AlgorithmOptions, CanBeGivenAgainFromTheReport) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"--paper"},
                                                    {"--paper", "--rows", "waypoint"},
                                                    {"--qp", "dense", "--resample", "off"},
                                                    {"--paper", "--resample", "scale"}}) {
    const auto report = json_of(arguments);
    std::vector<std::string> again;
    for (const char* name : {"sampler", "rows", "qp", "start", "resample", "segments"}) {
      again.insert(again.end(), {std::string("--") + name, report[name].get<std::string>()});
    }
    again.insert(again.end(), {"--merge-rule", report["merge"].get<std::string>()});
    if (!report["shortcut"].get<bool>()) again.emplace_back("--no-shortcut");
    if (!report["lattice"].get<bool>()) again.emplace_back("--no-lattice");
    if (!report["accept"].get<bool>()) again.emplace_back("--no-accept");
    EXPECT_EQ(json_of(again), report);
    // But for how long windows should be, which has no option of its own.
    const PlanOptions expected = plan_of(arguments);
    PlanOptions repeated = plan_of(again);
    repeated.steps_per_window = expected.steps_per_window;
    expect_same(repeated, expected);
  }
}

}  // namespace
}  // namespace sopt
