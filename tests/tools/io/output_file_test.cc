#include "tools/io/output_file.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

class OutputFileTest : public TemporaryFolderTest {
 protected:
  [[nodiscard]] std::string refusal(const std::vector<std::filesystem::path>& outputs,
                                    const std::vector<std::filesystem::path>& inputs = {}) const {
    try {
      check_outputs(outputs, inputs);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

// While it lives, no file can grow beyond `size_B`: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t size_B) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    (void)::getrlimit(RLIMIT_FSIZE, &saved_);
    const rlimit limit{size_B, saved_.rlim_max};
    (void)::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    (void)::setrlimit(RLIMIT_FSIZE, &saved_);
    (void)std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit saved_{};
  void (*handler_)(int);
};

TEST_F(OutputFileTest, WritesAndReplacesWholeFiles) {
  write("a", "something longer than the new text");
  write_files({{folder() / "a", "new"}, {folder() / "b", std::string(1 << 20, 'x')}});
  EXPECT_EQ(read_file(folder() / "a"), "new");
  EXPECT_EQ(read_file(folder() / "b"), std::string(1 << 20, 'x'));
  EXPECT_EQ(files(), (std::set<std::string>{"a", "b"}));
}

TEST_F(OutputFileTest, FullDiskLeavesEverythingAsItWas) {
  write("a", "old");
  {
    const FullDisk disk(1000);
    EXPECT_THROW(write_files({{folder() / "a", "new"}, {folder() / "b", std::string(5000, 'x')}}),
                 HostError);
  }
  EXPECT_EQ(read_file(folder() / "a"), "old");
  EXPECT_EQ(files(), std::set<std::string>{"a"});
}

TEST_F(OutputFileTest, FailedDeviceLeavesFilesAsTheyWere) {
  write("a", "old");
  EXPECT_THROW(write_files({{folder() / "a", "new"}, {"/dev/full", "x"}}), HostError);
  EXPECT_EQ(read_file(folder() / "a"), "old");
  EXPECT_EQ(files(), std::set<std::string>{"a"});
}

TEST_F(OutputFileTest, FolderThatRefusesIsNamed) {
  try {
    write_files({{"/proc/sopt.json", "x"}});
    FAIL() << "nothing can be created in /proc";
  } catch (const HostError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("/proc/sopt.json: cannot be written: ", 0), 0U);
  }
}

TEST_F(OutputFileTest, ReadOnlyFolderLeavesNothing) {
  constexpr uid_t kNobody = 65534;  // permissions do not hold for root
  const uid_t user = ::geteuid();
  ASSERT_EQ(::chmod(folder().c_str(), 0555), 0);
  if (user == 0) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  EXPECT_THROW(write_files({{folder() / "a", "x"}}), HostError);
  ASSERT_EQ(::seteuid(user), 0);
  ASSERT_EQ(::chmod(folder().c_str(), 0700), 0);
  EXPECT_EQ(files(), std::set<std::string>{});
}

TEST_F(OutputFileTest, WritesThroughSymbolicLinks) {
  write("real", "old");
  std::filesystem::create_symlink("real", folder() / "link");
  write_files({{folder() / "link", "new"}});
  EXPECT_TRUE(std::filesystem::is_symlink(folder() / "link"));
  EXPECT_EQ(read_file(folder() / "real"), "new");
}

TEST_F(OutputFileTest, DevicesStayDevices) {
  write_files({{"/dev/null", "x"}});
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, ChecksWhatCannotBeMeant) {
  const std::string a = write("a", "").string();
  std::filesystem::create_symlink("a", folder() / "link");
  const std::string there = folder().string();
  EXPECT_EQ(refusal({a, there + "/b", "/dev/null", "/dev/null"}, {there + "/c"}), "");
  EXPECT_EQ(refusal({there}), there + ": is a directory; an output must be a file");
  EXPECT_EQ(refusal({there + "/no/b"}), there + "/no/b: folder " + there +
                                            "/no does not exist; an output must be in an existing "
                                            "folder");
  EXPECT_EQ(refusal({a}, {there + "/link"}), a + ": is an input; an output must be another file");
  EXPECT_EQ(refusal({there + "/b", there + "/./b"}),
            there + "/./b: is asked for twice; outputs must be different files");
}

}  // namespace
}  // namespace sopt
