#include "tools/tables_command.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/tools/svg_reader.h"
#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

class TablesCommandTest : public TemporaryFolderTest {
 protected:
  // The exit code; 2: refused, `error_` says why.
  int run(const std::string& arguments) {
    CLI::App app;
    int exit_code = -1;
    add_tables_command(app, exit_code);
    testing::internal::CaptureStdout();
    try {
      app.parse("tables " + arguments);
    } catch (const CLI::ParseError& error) {
      error_ = error.what();
      exit_code = 2;
    } catch (const InputError& error) {
      error_ = error.what();
      exit_code = 2;
    }
    output_ = testing::internal::GetCapturedStdout();
    return exit_code;
  }
  [[nodiscard]] static std::string scene(const char* name = "plane_12.json") {
    return std::string(SOPT_SOURCE_DIR "/tools/scenes/plane/") + name;
  }
  [[nodiscard]] static std::string arm_scene(const char* name) {
    return std::string(SOPT_SOURCE_DIR "/tools/scenes/arm/") + name;
  }
  [[nodiscard]] bool says(const std::string& text) const {
    return output_.find(text) != std::string::npos;
  }

  std::string error_, output_;
};

TEST_F(TablesCommandTest, PrintsTheTablesAndWritesFiguresAndPictures) {
  const std::filesystem::path pictures = folder() / "new" / "pictures";
  EXPECT_EQ(run("plane " + scene() + " --seeds 1 --json " + (folder() / "t.json").string() +
                " --svg-dir " + pictures.string()),
            0);
  EXPECT_TRUE(says("1 scenes x 1 seeds"));
  EXPECT_TRUE(says("A: the paper's choices with its dense QP (1 cases"));
  EXPECT_TRUE(says("C: the defaults (1 cases, 1 solved by every column)"));
  EXPECT_TRUE(says("splitting cuts the optimisation time"));
  EXPECT_TRUE(says("--merge-rule printed"));

  const auto document = nlohmann::json::parse(read_file(folder() / "t.json"));
  EXPECT_EQ(document["schema"], 1);
  EXPECT_EQ(document["seeds"], 1);
  EXPECT_EQ(document["cases_unplanned"], 0);
  ASSERT_EQ(document["modes"].size(), 3U);
  const auto& column = document["modes"][0]["columns"][1];
  EXPECT_EQ(column["label"], "N = 3");
  EXPECT_EQ(column["options"]["qp"], "dense");
  EXPECT_EQ(column["optimise"]["serial_us"]["count"], 1);
  EXPECT_EQ(document["paper"]["columns"][0]["time_s"], 80.32);
  EXPECT_EQ(document["claims"].size(), 9U);
  EXPECT_EQ(document["switches"].size(), 12U);

  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(pictures)) {
    names.insert(entry.path().filename().string());
    EXPECT_GT(read_svg(read_file(entry.path())).size(), 20U) << entry.path();
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"concept.svg", "merging.svg", "segments.svg", "plan_1.svg"}));
}

TEST_F(TablesCommandTest, AnswersOneWhenACaseHasNoPlan) {
  const std::filesystem::path blocked = write("blocked.json", R"({
    "name": "blocked", "robot": "point2d", "radius": 0.1, "bounds": [0, 0, 4, 2],
    "start": [0.5, 1], "goal": [3.5, 1],
    "obstacles": [{"type": "disc", "center": [0.5, 1], "radius": 0.2}]})");
  EXPECT_EQ(run("plane " + blocked.string() + " --seeds 1 --svg-dir " + folder().string()), 1);
  EXPECT_TRUE(says("no case that every column solved"));
  EXPECT_TRUE(says("a column in which nothing was optimised"));
  EXPECT_FALSE(says("nan"));
  for (const char* const name : {"concept.svg", "merging.svg", "segments.svg", "plan_1.svg"}) {
    EXPECT_FALSE(read_svg(read_file(folder() / name)).empty()) << name;
  }
}

TEST_F(TablesCommandTest, NamesTheRobotsThatHaveTables) {
  EXPECT_EQ(run("mobile"), 2);
  EXPECT_NE(error_.find("\"mobile\" is not allowed; it must be one of \"plane\", \"arm\""),
            std::string::npos)
      << error_;
  EXPECT_EQ(error_.find('\n'), std::string::npos);
  EXPECT_EQ(run(""), 2);
  EXPECT_NE(error_.find("ROBOT is required"), std::string::npos) << error_;
}

TEST_F(TablesCommandTest, MakesBothHalvesOfTheArmsTable) {
  const std::filesystem::path pictures = folder() / "pictures";
  EXPECT_EQ(run("arm " + arm_scene("arm_2_05.json") + ' ' + arm_scene("arm_8_04.json") +
                " --seeds 1 --json " + (folder() / "t.json").string() + " --svg-dir " +
                pictures.string()),
            0);
  EXPECT_TRUE(says("2 scenes x 1 seeds"));
  EXPECT_TRUE(says("Table II of the paper, 2 obstacles"));
  EXPECT_TRUE(says("Table II of the paper, 7 to 9 obstacles"));
  EXPECT_TRUE(says("D: the defaults without their window check (1 cases"));
  EXPECT_TRUE(says("10 % at N = 1"));
  EXPECT_TRUE(says("of both families of scenes"));
  EXPECT_TRUE(says("length [rad]"));
  EXPECT_FALSE(says("nan"));

  const auto document = nlohmann::json::parse(read_file(folder() / "t.json"));
  EXPECT_EQ(document["schema"], 1);
  ASSERT_EQ(document["families"].size(), 2U);
  EXPECT_EQ(document["claims"].size(), 1U);
  const auto& many = document["families"][1];
  EXPECT_EQ(many["paper"]["columns"][0]["success_percent"], 10.0);
  ASSERT_EQ(many["modes"].size(), 4U);
  ASSERT_EQ(many["modes"][0]["columns"].size(), 8U);
  const auto& options = many["modes"][0]["columns"][5]["options"];
  EXPECT_EQ(options["qp"], "dense");
  EXPECT_EQ(options["rows"], "waypoint");
  EXPECT_EQ(options["resample"], "off");
  EXPECT_EQ(options["merge"], "printed");
  EXPECT_EQ(many["modes"][2]["columns"][1]["path_length_rad"]["count"], 1);

  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(pictures)) {
    names.insert(entry.path().filename().string());
    EXPECT_GT(read_svg(read_file(entry.path())).size(), 20U) << entry.path();
  }
  EXPECT_EQ(names, (std::set<std::string>{"concept_arm.svg", "merging_arm.svg"}));
}

TEST_F(TablesCommandTest, RefusesScenesThatAreInNoHalfOfTheArmsTable) {
  EXPECT_EQ(run("arm " + scene()), 2);
  EXPECT_NE(error_.find("plane_12.json: robot: point2d is not an arm"), std::string::npos)
      << error_;
  const std::filesystem::path free = write("free.json", R"({
    "name": "free", "robot": "lr_mate_200id_7l", "start": [0, 0, 0, 0, 0],
    "goal": [0.5, 0, 0, 0, 0], "obstacles": []})");
  EXPECT_EQ(run("arm " + free.string()), 2);
  EXPECT_NE(error_.find("free.json: obstacles: 0 is not allowed"), std::string::npos) << error_;
  EXPECT_EQ(output_, "");
}

TEST_F(TablesCommandTest, RefusesWhatItCannotDoBeforeAnyWork) {
  EXPECT_EQ(run("plane --seeds 0"), 2);
  EXPECT_EQ(run("plane " + scene() + " --json " + (folder() / "missing" / "t.json").string()), 2);
  EXPECT_EQ(run("plane " + (folder() / "missing.json").string()), 2);
  const std::filesystem::path file = write("file", "");
  EXPECT_EQ(run("plane " + scene() + " --svg-dir " + file.string()), 2);
  EXPECT_NE(error_.find("is not a folder"), std::string::npos);
  EXPECT_EQ(output_, "");
}

}  // namespace
}  // namespace sopt
