// Writes the shipped scenes: `sopt_make_scenes tools/scenes`. The same bytes on every run,
// so a difference to the files that are there is a change of the generator.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <vector>

#include "tools/io/output_file.h"
#include "tools/scenes/arm_scene_generator.h"
#include "tools/scenes/scene_generator.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    (void)std::fprintf(stderr, "usage: sopt_make_scenes DIR\n");
    return 2;
  }
  try {
    std::vector<sopt::OutputFile> files;
    const auto add = [&](const auto& scenes) {
      for (const auto& scene : scenes) {
        files.push_back({std::filesystem::path(argv[1]) / scene.file, sopt::to_json_text(scene)});
        std::filesystem::create_directories(files.back().file.parent_path());
      }
    };
    add(sopt::generate_scenes());
    add(sopt::generate_arm_scenes());
    sopt::write_files(files);
  } catch (const std::exception& error) {
    (void)std::fprintf(stderr, "sopt_make_scenes: %s\n", error.what());
    return 3;
  }
  return 0;
}
