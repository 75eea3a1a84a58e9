// The page in a real browser: a headless Chromium runs it together with a script that collects what
// went wrong, looks at the canvas and moves the time. Pages by hand and pages of real plans.
// Skipped where there is none.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/html_scenes.h"
#include "tests/tools/temporary_folder.h"

namespace sopt {
namespace {

// Before all other scripts.
constexpr const char* kCollect = R"(<script>
window.problems = [];
window.onerror = (message) => { window.problems.push(String(message)); };
for (const kind of ['error', 'warn']) {
  console[kind] = (...words) => { window.problems.push(words.join(' ')); };
}
</script>)";

// After them. Pixels are read in the task that drew them; later the buffer is empty.
constexpr const char* kLook = R"(<script>
(() => {
  const canvas = document.querySelector('canvas');
  const scrub = document.getElementById('scrub');
  const at = (share) => {
    scrub.value = 1000 * share;
    scrub.dispatchEvent(new Event('input'));
    const gl = canvas.getContext('webgl2');
    const pixels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  const result = {};
  try {
    const begin = at(0);
    const middle = at(0.5);
    const again = at(0.5);
    const differing = (a, b) => a.reduce((n, v, i) => n + (Math.abs(v - b[i]) > 8 ? 1 : 0), 0);
    result.num_pixels = canvas.width * canvas.height;
    result.num_drawn = begin.reduce((n, v) => n + (v < 200 ? 1 : 0), 0);
    result.num_moved = differing(begin, middle);
    result.num_unsteady = differing(middle, again);
    result.time = document.getElementById('time').textContent;
    result.title = document.title;
    result.num_curves = document.querySelectorAll('#plots path').length;
    result.num_limits = document.querySelectorAll('#plots line.limit').length;
    result.failure = document.getElementById('failure').textContent;
    result.has_player = document.getElementById('player').offsetHeight > 0;
    result.plots = [...document.querySelectorAll('#plots h2')].map((h) => h.firstChild.textContent);
    result.message = document.getElementById('message').textContent;
    const play = document.getElementById('play');
    play.click();
    result.playing = play.textContent;
    play.click();
    result.paused = play.textContent;
  } catch (error) {
    window.problems.push(String(error));
  }
  result.problems = window.problems;
  const answer = document.createElement('pre');
  answer.id = 'answer';
  answer.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(result))));
  document.body.append(answer);
})();
</script>)";

std::string from_base64(const std::string& text) {
  std::string bytes;
  unsigned bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t value = alphabet.find(c);
    if (value == std::string::npos) break;
    bits = (bits << 6U) | static_cast<unsigned>(value);
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes += static_cast<char>((bits >> static_cast<unsigned>(num_bits)) & 0xFFU);
  }
  return bytes;
}

class HtmlBrowserTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      if (std::system(("command -v " + std::string(name) + " >/dev/null").c_str()) == 0) {
        browser_ = name;
        return;
      }
    }
    GTEST_SKIP() << "no chromium, chromium-browser or google-chrome on the path";
  }

  // What kLook saw on the page; null when the browser gave no answer.
  nlohmann::json look_at(const HtmlScene& scene) { return look_at(html_page(scene)); }

  // Likewise of what `sopt plan` writes for a scene file.
  nlohmann::json look_at_plan(const std::filesystem::path& scene, int exit_code) {
    const std::string file = (folder() / "plan.html").string();
    const int status = std::system(("'" SOPT_PROGRAM "' plan '" + scene.string() + "' --html '" +
                                    file + "' >'" + (folder() / "out").string() + "'")
                                       .c_str());
    EXPECT_EQ(WEXITSTATUS(status), exit_code);
    return look_at(read_file(file));
  }
  [[nodiscard]] static std::filesystem::path shipped(const char* name) {
    return std::filesystem::path(SOPT_SOURCE_DIR) / "tools/scenes" / name;
  }

  nlohmann::json look_at(std::string page) {
    page.insert(page.find("</body>"), kLook);
    page.insert(page.find("<head>") + 6, kCollect);
    const std::string file = write("page.html", page).string();
    const std::string dom = (folder() / "dom.html").string();
    const std::string command =
        "timeout 120 " + browser_ +
        " --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader"
        " --disable-extensions --window-size=1200,800 --user-data-dir='" +
        (folder() / "profile").string() + "' --dump-dom 'file://" + file + "' >'" + dom + "' 2>'" +
        (folder() / "log").string() + "'";
    const int status = std::system(command.c_str());
    const std::string text = read_file(dom);
    const std::string open = "<pre id=\"answer\">";
    const std::size_t begin = text.find(open);
    if (begin == std::string::npos) {
      ADD_FAILURE() << "status " << status << '\n' << read_file(folder() / "log");
      return nullptr;
    }
    return nlohmann::json::parse(from_base64(text.substr(begin + open.size())));
  }

  static void expect_a_moving_picture(const nlohmann::json& answer) {
    EXPECT_EQ(answer["problems"], nlohmann::json::array());
    EXPECT_EQ(answer["message"], "");
    EXPECT_GT(answer["num_pixels"], 100000);
    EXPECT_GT(answer["num_drawn"], 1000);
    EXPECT_GT(answer["num_moved"], 1000);
    EXPECT_EQ(answer["num_unsteady"], 0);
    EXPECT_EQ(answer["playing"], "pause");
    EXPECT_EQ(answer["paused"], "play");
  }

  std::string browser_;
};

TEST_F(HtmlBrowserTest, AnArmIsDrawnAndScrubbingMovesIt) {
  const nlohmann::json answer = look_at(swinging_arm());
  ASSERT_TRUE(answer.is_object());
  expect_a_moving_picture(answer);
  EXPECT_EQ(answer["time"], "0.50 / 1.00 s");
  EXPECT_EQ(answer["title"], "swing");
  EXPECT_EQ(answer["num_curves"], 2);
  EXPECT_EQ(answer["num_limits"], 5);  // lower and upper of both curves, and the level
}

TEST_F(HtmlBrowserTest, ADiscInThePlaneLikewise) {
  const nlohmann::json answer = look_at(moving_disc());
  ASSERT_TRUE(answer.is_object());
  expect_a_moving_picture(answer);
}

TEST_F(HtmlBrowserTest, HostileNamesAreShownAsTheyAre) {
  HtmlScene scene = swinging_arm();
  scene.title = "</script><script>throw 1</script><b>&amp;";
  scene.plots[0].series[0].name = "<img src=x onerror=\"throw 2\">";
  const nlohmann::json answer = look_at(scene);
  ASSERT_TRUE(answer.is_object());
  EXPECT_EQ(answer["problems"], nlohmann::json::array());
  EXPECT_EQ(answer["title"], scene.title);
}

TEST_F(HtmlBrowserTest, ASceneWithoutAPlanIsDrawnAndSaysWhy) {
  const nlohmann::json answer = look_at(arm_without_plan());
  ASSERT_TRUE(answer.is_object());
  EXPECT_EQ(answer["problems"], nlohmann::json::array());
  EXPECT_GT(answer["num_drawn"], 1000);
  EXPECT_EQ(answer["num_moved"], 0);
  EXPECT_EQ(answer["has_player"], false);
  EXPECT_EQ(answer["failure"], "goal is too close: obstacle 2");
}

TEST_F(HtmlBrowserTest, APlanOfAnArmPlays) {
  const nlohmann::json answer = look_at_plan(shipped("arm/arm_8_03.json"), 0);
  ASSERT_TRUE(answer.is_object());
  expect_a_moving_picture(answer);
  EXPECT_EQ(answer["has_player"], true);
  EXPECT_EQ(answer["failure"], "");
  EXPECT_EQ(answer["plots"], nlohmann::json({"position [rad]", "velocity [rad/s]",
                                             "acceleration [rad/s\u00b2]", "clearance [m]"}));
  EXPECT_EQ(answer["num_curves"], 3 * 5 + 2);
}

TEST_F(HtmlBrowserTest, APlanInThePlanePlays) {
  const nlohmann::json answer = look_at_plan(shipped("plane_long.json"), 0);
  ASSERT_TRUE(answer.is_object());
  EXPECT_EQ(answer["problems"], nlohmann::json::array());
  EXPECT_GT(answer["num_moved"], 100);  // a small disc
  EXPECT_EQ(answer["plots"], nlohmann::json({"position [m]", "velocity [m/s]", "clearance [m]"}));
}

TEST_F(HtmlBrowserTest, AFailureOfTheProgramIsShown) {
  auto scene = nlohmann::json::parse(read_file(shipped("arm/factory.json")));
  scene["goal"] = scene["start"];
  scene["goal"][0] = -0.5;  // in the front pillar
  const nlohmann::json answer = look_at_plan(write("scene.json", scene.dump()), 1);
  ASSERT_TRUE(answer.is_object());
  EXPECT_EQ(answer["problems"], nlohmann::json::array());
  EXPECT_NE(answer["failure"].get<std::string>().find("front_pillar"), std::string::npos);
  EXPECT_GT(answer["num_drawn"], 1000);
}

TEST_F(HtmlBrowserTest, WhatGoesWrongInThePageIsSeen) {
  std::string page = html_page(swinging_arm());
  page.replace(page.find("\"obstacles\""), 11, "\"obstacle_\"");
  const nlohmann::json answer = look_at(page);
  ASSERT_TRUE(answer.is_object());
  EXPECT_NE(answer["problems"], nlohmann::json::array());
}

}  // namespace
}  // namespace sopt
