#include "tools/io/file_list.h"

#include <filesystem>
#include <string>
#include <vector>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

using FileListTest = TemporaryFolderTest;

TEST_F(FileListTest, ListsFoldersByNameAndKeepsFilesAsGiven) {
  const auto b = write("b.json", "{}");
  const auto a = write("a.json", "{}");
  const auto other = write("other.txt", "");
  const std::vector<std::filesystem::path> expected = {other, a, b};
  EXPECT_EQ(list_files({other.string(), folder().string()}, ".json"), expected);
}

TEST_F(FileListTest, RefusesAFolderWithoutSuchFiles) {
  (void)write("b.json", "{}");
  EXPECT_THROW((void)list_files({folder().string()}, ".qp"), InputError);
}

TEST_F(FileListTest, KeepsWhatDoesNotExistForTheReaderToRefuse) {
  const std::vector<std::filesystem::path> expected = {"no/such/file.json"};
  EXPECT_EQ(list_files({"no/such/file.json"}, ".json"), expected);
}

}  // namespace
}  // namespace sopt
