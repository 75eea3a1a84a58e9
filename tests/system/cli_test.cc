// The `sopt` program from outside: what it prints, answers and writes when the input is sound.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/system/program.h"

namespace sopt {
namespace {

using nlohmann::json;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::string line;
  for (const char c : text) {
    if (c == '\n') {
      lines.push_back(line);
      line.clear();
    } else {
      line += c;
    }
  }
  return lines;
}

class CliTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write("scene.json", good_scene());
  }

  // The good scene with one field replaced.
  void write_scene(const char* field, const json& value) {
    json scene = json::parse(good_scene());
    scene[field] = value;
    write("scene.json", scene.dump());
  }
  [[nodiscard]] json read_json(const std::string& name) const { return json::parse(read(name)); }
};

TEST_F(CliTest, PlanReportsAndWritesNothingByDefault) {
  const ProgramRun result = run("plan scene.json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.rfind("ok  three_obstacles: verified plan in ", 0), 0U) << result.out;
  EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
}

TEST_F(CliTest, PlanWritesEveryFieldOfTheFormat) {
  ASSERT_EQ(run("plan scene.json -o plan.json --seed 42").exit_code, 0);
  const json plan = read_json("plan.json");
  for (const char* name : {"schema",         "scene",
                           "robot",          "seed",
                           "status",         "dt_s",
                           "horizon",        "states",
                           "inputs",         "path",
                           "path_length",    "cost",
                           "duration_s",     "sampler_path_length",
                           "iterations",     "segments_initial",
                           "segments_final", "history",
                           "margin",         "min_clearance",
                           "certificate",    "times_us",
                           "counts"}) {
    EXPECT_TRUE(plan.contains(name)) << name;
  }
  EXPECT_FALSE(plan.contains("failure"));
  EXPECT_EQ(plan["schema"], 1);
  EXPECT_EQ(plan["seed"], 42);
  EXPECT_EQ(plan["scene"], "three_obstacles");
  EXPECT_EQ(plan["status"], "ok");
  const std::size_t horizon = plan["horizon"];
  EXPECT_EQ(plan["states"].size(), horizon + 1);
  EXPECT_EQ(plan["inputs"].size(), horizon);
  EXPECT_EQ(plan["states"].front(), json({1, 3}));
  EXPECT_EQ(plan["states"].back(), json({9, 3}));
  EXPECT_EQ(plan["history"].size(), plan["iterations"].get<std::size_t>() + 1);
  EXPECT_DOUBLE_EQ(plan["duration_s"], plan["dt_s"].get<double>() * static_cast<double>(horizon));
  EXPECT_GE(plan["certificate"]["min_clearance_m"], plan["min_clearance"]);
}

TEST_F(CliTest, WrittenPlanVerifiesWithTheSameCertificate) {
  ASSERT_EQ(run("plan scene.json -o plan.json").exit_code, 0);
  const ProgramRun result = run("verify scene.json plan.json --json answer.json");
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_EQ(result.out.rfind("verified  three_obstacles, ", 0), 0U) << result.out;
  const json answer = read_json("answer.json");
  EXPECT_EQ(answer["verified"], true);
  EXPECT_EQ(answer["certificate"], read_json("plan.json")["certificate"]);
}

TEST_F(CliTest, SameSeedSameMotion) {
  ASSERT_EQ(run("plan scene.json --seed 5 -o a.json --csv a.csv").exit_code, 0);
  ASSERT_EQ(run("plan scene.json --seed 5 -o b.json --csv b.csv --repeat 3").exit_code, 0);
  EXPECT_EQ(read("a.csv"), read("b.csv"));
  EXPECT_EQ(read_json("a.json")["states"], read_json("b.json")["states"]);
}

TEST_F(CliTest, CsvHasOneLinePerWaypoint) {
  ASSERT_EQ(run("plan scene.json -o plan.json --csv plan.csv").exit_code, 0);
  const json plan = read_json("plan.json");
  const std::vector<std::string> lines = lines_of(read("plan.csv"));
  ASSERT_EQ(lines.size(), plan["states"].size() + 1);
  EXPECT_EQ(lines[0], "t_s,x_m,y_m,vx_mps,vy_mps");
  EXPECT_EQ(lines[1].rfind("0,1,3,", 0), 0U) << lines[1];
  const std::string last = ",9,3,,";
  EXPECT_EQ(lines.back().substr(lines.back().size() - last.size()), last);
  for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 4);
}

TEST_F(CliTest, OptionsReachThePlanner) {
  ASSERT_EQ(run("plan scene.json -o plan.json --segments 5 --no-merge --no-shortcut --dt 0.05 "
                "--speed 2 --margin 0.11 --resample off --max-window 30 --streams 2 "
                "--sampler rrt_star --samples 5000 --deadline-ms 60000 --robot point2d")
                .exit_code,
            0);
  const json plan = read_json("plan.json");
  EXPECT_EQ(plan["segments_initial"], 5);
  EXPECT_EQ(plan["dt_s"], 0.05);
  EXPECT_EQ(plan["margin"], 0.11);
  double longest_m = 0.0;
  for (const json& input : plan["inputs"]) {
    longest_m = std::max(longest_m, std::hypot(input[0].get<double>(), input[1].get<double>()));
  }
  EXPECT_GT(longest_m, 1.0);
}

TEST_F(CliTest, SceneValuesHoldAndOptionsGoBefore) {
  json scene = json::parse(good_scene());
  scene["dt"] = 0.2;
  scene["margin"] = 0.12;
  scene["min_clearance"] = 0.001;
  scene["limits"]["v_max"] = 0.5;
  scene["start_velocity"] = {0.1, 0.1};
  write("scene.json", scene.dump());
  ASSERT_EQ(run("plan scene.json -o plan.json --margin 0.08 --resample off").exit_code, 0);
  const json plan = read_json("plan.json");
  EXPECT_EQ(plan["dt_s"], 0.2);
  EXPECT_EQ(plan["margin"], 0.08);
  EXPECT_EQ(plan["min_clearance"], 0.001);
  EXPECT_GE(plan["certificate"]["worst_limit_margin"], 0.0);
  EXPECT_LT(plan["certificate"]["worst_limit_margin"], 1.0);
}

TEST_F(CliTest, PaperModePlansAndVerifies) {
  for (const std::string options :
       {"--paper", "--paper --rows waypoint --qp kernel", "--paper --merge-rule paired",
        "--rows label_map --no-accept", "--qp dense --start zero_input", "--resample rediscretise",
        "--paper --segments 9 --no-merge --max-window 10"}) {
    SCOPED_TRACE(options);
    const ProgramRun planned = run("plan scene.json -o plan.json --seed 3 " + options);
    ASSERT_EQ(planned.exit_code, 0) << planned.out << planned.err;
    const json plan = read_json("plan.json");
    EXPECT_EQ(plan["status"], "ok");
    EXPECT_EQ(plan["states"].size(), plan["horizon"].get<std::size_t>() + 1);
    EXPECT_EQ(plan["inputs"].size(), plan["horizon"].get<std::size_t>());
    const ProgramRun verified = run("verify scene.json plan.json --json answer.json");
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
    EXPECT_EQ(read_json("answer.json")["certificate"], plan["certificate"]);
  }
}

TEST_F(CliTest, PaperModeMakesTheSameMotionTwice) {
  ASSERT_EQ(run("plan scene.json --paper --seed 5 -o a.json --csv a.csv").exit_code, 0);
  ASSERT_EQ(run("plan scene.json --paper --seed 5 -o b.json --csv b.csv --repeat 3").exit_code, 0);
  EXPECT_EQ(read("a.csv"), read("b.csv"));
  for (const char* name : {"dt_s", "states", "inputs", "path", "cost", "certificate", "counts"}) {
    EXPECT_EQ(read_json("a.json")[name], read_json("b.json")[name]) << name;
  }
  // It is not what is planned without it.
  ASSERT_EQ(run("plan scene.json --seed 5 -o c.json").exit_code, 0);
  EXPECT_NE(read_json("a.json")["states"], read_json("c.json")["states"]);
}

TEST_F(CliTest, PaperModeKeepsTheTimeStepAndCountsSteps) {
  ASSERT_EQ(run("plan scene.json --paper --speed 2 --dt 0.1 -o plan.json").exit_code, 0);
  const json plan = read_json("plan.json");
  EXPECT_EQ(plan["dt_s"], 0.1);
  // A step is 0.2 m: the horizon follows the path, but for what the last sweep has saved.
  const double needed = plan["path_length"].get<double>() / 0.2;
  EXPECT_GE(plan["horizon"], needed * (1.0 - 1e-9));
  EXPECT_LE(plan["horizon"], 1.1 * needed + 2.0);
}

TEST_F(CliTest, PlanZeroThatLeavesInPaperModeVerifies) {
  // Steps of 1 m over a wall of 0.04 m: waypoint rows let the optimised plan through it.
  json scene = json::parse(good_scene());
  const json wall = {{"type", "box"}, {"center", {5, 2.5}}, {"size", {0.04, 5}}};
  scene["obstacles"] = json::array({wall});
  write("scene.json", scene.dump());
  int num_refused = 0;
  for (const std::string seed : {"1", "2", "3", "4", "5"}) {
    SCOPED_TRACE(seed);
    const ProgramRun planned =
        run("plan scene.json --paper --speed 10 -o plan.json --svg plan.svg --seed " + seed);
    ASSERT_EQ(planned.exit_code, 0);
    if (planned.out.find("its result was refused") != std::string::npos) ++num_refused;
    const json plan = read_json("plan.json");
    EXPECT_EQ(plan["status"], "ok");
    EXPECT_EQ(run("verify scene.json plan.json").exit_code, 0);
    double length_m = 0.0;
    for (std::size_t t = 1; t < plan["states"].size(); ++t) {
      const json& a = plan["states"][t - 1];
      const json& b = plan["states"][t];
      length_m += std::hypot(b[0].get<double>() - a[0].get<double>(),
                             b[1].get<double>() - a[1].get<double>());
    }
    EXPECT_NEAR(plan["path_length"], length_m, 1e-9);
  }
  EXPECT_GT(num_refused, 0);
}

TEST_F(CliTest, SpeedAboveTheLimitIsWrongUsage) {
  write_scene("limits", {{"v_max", 1.0}});
  const ProgramRun result = run("plan scene.json --speed 1.5 -o plan.json");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "sopt: --speed: 1.5 is not allowed; it must be at most limits.v_max of "
            "scene.json, 1\n");
  EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
}

TEST_F(CliTest, BlockedStartIsAnAnswerWithReasonAndFiles) {
  write_scene("start", {5.5, 2.5});
  const ProgramRun result =
      run("plan scene.json -o plan.json --svg plan.svg --csv plan.csv --repeat 2");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.rfind("bad_start  three_obstacles: no plan", 0), 0U) << result.out;
  EXPECT_NE(result.out.find("from obstacle \"crate\""), std::string::npos) << result.out;
  const json plan = read_json("plan.json");
  EXPECT_EQ(plan["status"], "bad_start");
  EXPECT_EQ(plan["horizon"], 0);
  EXPECT_EQ(plan["states"], json::array());
  EXPECT_TRUE(plan["dt_s"].is_null());
  EXPECT_TRUE(plan["certificate"].is_null());
  EXPECT_EQ(plan["failure"]["stage"], "request");
  EXPECT_EQ(plan["failure"]["obstacle"], "crate");
  EXPECT_LT(plan["failure"]["amount"], 0.0);
  EXPECT_EQ(read("plan.csv"), "t_s,x_m,y_m,vx_mps,vy_mps\n");
  EXPECT_NE(read("plan.svg").find("bad_start"), std::string::npos);

  const ProgramRun verified = run("verify scene.json plan.json");
  EXPECT_EQ(verified.exit_code, 1);
  EXPECT_EQ(verified.out,
            "rejected  three_obstacles, 0 steps\n"
            "  the file holds no plan, its status is bad_start\n");
}

TEST_F(CliTest, GoalOutsideNamesTheBounds) {
  write_scene("goal", {9.0, 60.0});
  EXPECT_EQ(run("plan scene.json -o plan.json --svg plan.svg").exit_code, 1);
  const json plan = read_json("plan.json");
  EXPECT_EQ(plan["status"], "bad_goal");
  EXPECT_EQ(plan["failure"]["obstacle"], "bounds");
}

TEST_F(CliTest, WalledInGoalHasNoPath) {
  json scene = json::parse(good_scene());
  scene["obstacles"].push_back({{"type", "box"}, {"center", {6.7, 3}}, {"size", {0.2, 6}}});
  write("scene.json", scene.dump());
  const ProgramRun result = run("plan scene.json -o plan.json --svg plan.svg --samples 500");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(read_json("plan.json")["status"], "no_path");
  EXPECT_EQ(read_json("plan.json")["failure"]["stage"], "sample");
  EXPECT_TRUE(read_json("plan.json")["failure"]["obstacle"].is_null());
  EXPECT_NE(result.out.find("  reason        "), std::string::npos) << result.out;
}

TEST_F(CliTest, DeadlineThatIsTooShortIsAnAnswer) {
  const ProgramRun result = run("plan scene.json -o plan.json --deadline-ms 1e-6");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(read_json("plan.json")["status"], "deadline");
}

TEST_F(CliTest, TooManyStepsIsAnAnswer) {
  EXPECT_EQ(run("plan scene.json -o plan.json --speed 1e-9 --dt 1e-9").exit_code, 1);
  EXPECT_EQ(read_json("plan.json")["status"], "capacity");
}

TEST_F(CliTest, StartAtGoalIsAPlanThatStays) {
  write_scene("goal", {1, 3});
  EXPECT_EQ(run("plan scene.json -o plan.json --svg plan.svg").exit_code, 0);
  EXPECT_GE(read_json("plan.json")["horizon"], 2);
  EXPECT_EQ(run("verify scene.json plan.json").exit_code, 0);
}

TEST_F(CliTest, HelpIsEverywhere) {
  for (const char* arguments : {"--help", "plan --help", "verify --help", "bench --help"}) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments;
    EXPECT_NE(result.out.find("Usage: sopt"), std::string::npos) << arguments;
    EXPECT_EQ(result.err, "") << arguments;
  }
}

TEST_F(CliTest, StdoutAndPipesCanBeOutputs) {
  const ProgramRun result = run("plan scene.json --csv /dev/stdout -o /dev/null");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.rfind("t_s,x_m,y_m,vx_mps,vy_mps\n", 0), 0U);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(CliTest, FullDiskIsAHostProblemAndLeavesNothing) {
  // Two blocks of 1024 bytes are less than the plan needs.
  const ProgramRun result =
      run("plan scene.json -o plan.json --svg plan.svg", "ulimit -f 2 && trap '' XFSZ");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.err, "sopt: plan.json: cannot be written: File too large\n");
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
}

TEST_F(CliTest, FailedWriteKeepsTheOldFile) {
  write("plan.json", "old");
  EXPECT_EQ(run("plan scene.json -o plan.json", "ulimit -f 2 && trap '' XFSZ").exit_code, 3);
  EXPECT_EQ(read("plan.json"), "old");
  EXPECT_EQ(files(), (std::set<std::string>{"plan.json", "scene.json"}));
}

// --- verify

class VerifyCliTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    plan_ = json::parse(read_file(data_file("three_obstacles_plan.json")));
  }

  // What `verify` says about `plan_`, second line; the exit code must be 1.
  std::string rejection() {
    write("plan.json", plan_.dump());
    const ProgramRun result = run("verify scene.json plan.json --json answer.json");
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(read_json("answer.json")["verified"], false);
    const std::vector<std::string> lines = lines_of(result.out);
    EXPECT_EQ(lines[0], "rejected  three_obstacles, 3 steps");
    return lines.back();
  }
  [[nodiscard]] json violation() const { return read_json("answer.json")["violation"]; }

  json plan_;
};

TEST_F(VerifyCliTest, AcceptsAPlanMadeByHand) {
  write("plan.json", plan_.dump());
  const ProgramRun result = run("verify scene.json plan.json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.rfind("verified  three_obstacles, 3 steps\n"
                             "  clearance     0.4 m at 1 s, from the bounds\n",
                             0),
            0U)
      << result.out;
}

TEST_F(VerifyCliTest, NamesObstacleTimeAndClearanceOfACollision) {
  plan_["states"] = {{1, 3}, {4.25, 2.5}, {7, 1}, {9, 3}};
  plan_["inputs"] = {{3.25, -0.5}, {2.75, -1.5}, {2, 2}};
  EXPECT_NE(rejection().find("too close at "), std::string::npos);
  EXPECT_EQ(violation()["kind"], "collision");
  EXPECT_EQ(violation()["obstacle"], 0);
  EXPECT_LT(violation()["amount"], 0.0);
}

TEST_F(VerifyCliTest, NamesAStartThatIsNotTheScenes) {
  plan_["states"][0] = {1, 2.5};
  plan_["inputs"][0] = {0, 2.9};
  EXPECT_EQ(rejection(), "  the first state is not the start at 0 s (step 0): 0.5 m away");
}

TEST_F(VerifyCliTest, NamesAGoalThatIsNotReached) {
  plan_["states"][3] = {9, 4};
  plan_["inputs"][2] = {0, -1.4};
  EXPECT_EQ(rejection(), "  the last state is not the goal at 3 s (step 2): 1 m away");
}

TEST_F(VerifyCliTest, NamesAStepThatDoesNotFollow) {
  plan_["inputs"][1] = {8, 0.001};
  EXPECT_EQ(rejection(),
            "  the next state does not follow from the input at 2 s (step 1): defect "
            "0.001 m, at most 1e-09 allowed");
}

TEST_F(VerifyCliTest, NamesAStepThatIsTooFast) {
  write_scene("limits", {{"v_max", 7.5}});
  EXPECT_EQ(rejection(),
            "  faster than the limit at 1 s (step 1): by 0.5 m/s, the limit is 7.5 m/s");
}

TEST_F(VerifyCliTest, RefusesNumbersThatOverflow) {
  for (const double huge : {1e300, -1.7e308}) {
    plan_["states"][1] = {huge, huge};
    plan_["inputs"][0] = {huge, huge};
    plan_["inputs"][1] = {-huge, -huge};
    (void)rejection();
  }
}

TEST_F(VerifyCliTest, SaysWhenThePlanIsOfAnotherScene) {
  plan_["scene"] = "elsewhere";
  write("plan.json", plan_.dump());
  const ProgramRun result = run("verify scene.json plan.json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("  note          the scene here is three_obstacles\n"),
            std::string::npos);
}

// --- public scenes, where they are at hand

TEST_F(CliTest, SharedScenesPlanAndVerify) {
  const std::filesystem::path folder =
      std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/scenes";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is absent";
  int num_planar = 0;
  int num_arms = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string scene = "'" + entry.path().string() + "'";
    const json document = json::parse(read_file(entry.path()));
    if (document.contains("base_model")) {
      EXPECT_EQ(run("plan " + scene).exit_code, 2) << scene << ": mobile manipulators";
      continue;
    }
    const bool is_planar = document["robot"] == "point2d";
    ++(is_planar ? num_planar : num_arms);
    const std::string picture = is_planar ? " --svg plan.svg" : "";
    EXPECT_EQ(run("plan " + scene + " -o plan.json" + picture).exit_code, 0) << scene;
    EXPECT_EQ(run("verify " + scene + " plan.json").exit_code, 0) << scene;
  }
  EXPECT_EQ(num_planar, 10);
  EXPECT_EQ(num_arms, 28);
}

}  // namespace
}  // namespace sopt
