// Files that are either whole or absent: text is written under a temporary name in the target's
// folder, flushed to the disk and renamed. Several files are all written before the first rename.
// Targets that are not regular files (/dev/stdout, a pipe) are written directly.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sopt {

struct OutputFile {
  std::filesystem::path file;
  std::string text;
};

// Refuses, before any work is done, outputs that cannot be meant: a directory, a file in a folder
// that does not exist, the same file twice, an input. Throws InputError.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs);

// Throws HostError; then no target was touched, unless a rename itself failed.
void write_files(const std::vector<OutputFile>& files);

}  // namespace sopt
