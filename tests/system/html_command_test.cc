// `sopt plan --html` and `--svg` from outside, for arms and in the plane.
#include <string>

#include "tests/system/program.h"

namespace sopt {
namespace {

class HtmlCommandTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write("plane.json", good_scene());
    const auto arm = std::filesystem::path(SOPT_SOURCE_DIR) / "tools/scenes/arm/arm_8_03.json";
    write("arm.json", read_file(arm));
  }
  [[nodiscard]] bool contains(const std::string& name, const std::string& part) const {
    return read(name).find(part) != std::string::npos;
  }
};

TEST_F(HtmlCommandTest, PagesAndPicturesAreWrittenWhole) {
  for (const std::string scene : {"plane", "arm"}) {
    const ProgramRun result = run("plan " + scene + ".json --html p.html --svg p.svg");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("p.svg, p.html"), std::string::npos) << result.out;
    EXPECT_TRUE(contains("p.html", "<!DOCTYPE html>"));
    EXPECT_TRUE(read("p.html").ends_with("</html>\n"));
    EXPECT_TRUE(read("p.svg").ends_with("</svg>\n"));
    EXPECT_EQ(files(), (std::set<std::string>{"arm.json", "p.html", "p.svg", "plane.json"}));
  }
  EXPECT_TRUE(contains("p.html", "\"title\":\"arm_8_03: ok\""));
}

TEST_F(HtmlCommandTest, WithoutAPlanTheySayWhy) {
  for (const std::string scene : {"plane", "arm"}) {
    const ProgramRun result =
        run("plan " + scene + ".json --deadline-ms 1e-6 --html p.html --svg p.svg");
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_TRUE(contains("p.html", "deadline\""));
    EXPECT_TRUE(contains("p.html", "\"frames\":[]"));
    EXPECT_TRUE(contains("p.svg", "#c62828"));
  }
}

TEST_F(HtmlCommandTest, FilesThatCannotBeMeantAreRefused) {
  for (const std::string arguments :
       {"--html absent/p.html", "--html plane.json", "--html p -o p", "--html ''"}) {
    const ProgramRun result = run("plan plane.json " + arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(result.err.empty());
    EXPECT_EQ(files(), (std::set<std::string>{"arm.json", "plane.json"}));
  }
  EXPECT_NE(run("plan plane.json --html absent/p.html").err.find("absent"), std::string::npos);
}

}  // namespace
}  // namespace sopt
