// Runs the `sopt` program in a folder of its own, so that tests see exactly what it prints and
// which files it leaves.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/tools/temporary_folder.h"

namespace sopt {

struct ProgramRun {
  int exit_code = -1;
  std::string out;
  std::string err;
};

class ProgramTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    std::filesystem::create_directory(outside());
  }
  void TearDown() override {
    std::filesystem::remove_all(outside());
    TemporaryFolderTest::TearDown();
  }

  // `arguments` as typed in a shell whose current folder is `folder()`; `before` is run first.
  ProgramRun run(const std::string& arguments, const std::string& before = ":") {
    const std::filesystem::path out = outside() / "out";
    const std::filesystem::path err = outside() / "err";
    const std::string command = "cd '" + folder().string() + "' && " + before + " && '" +
                                SOPT_PROGRAM "' " + arguments + " >'" + out.string() + "' 2>'" +
                                err.string() + "' </dev/null";
    ProgramRun result;
    const int status = std::system(("bash -c " + quoted(command)).c_str());
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.out = read_file(out);
    result.err = read_file(err);
    return result;
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    return read_file(folder() / name);
  }

  // A scene that plans.
  [[nodiscard]] static std::string good_scene() {
    return read_file(data_file("three_obstacles.json"));
  }

 private:
  [[nodiscard]] std::filesystem::path outside() const { return folder().string() + ".outside"; }

  static std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
  }
};

}  // namespace sopt
