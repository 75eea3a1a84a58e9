#include "tools/io/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int error) {
  throw HostError(printable(file.string(), 400) + ": cannot be written: " + std::strerror(error));
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

bool is_special(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  return fs::exists(status) && !fs::is_regular_file(status);
}

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  return fs::absolute(a, error).lexically_normal() == fs::absolute(b, error).lexically_normal();
}

// Returns errno, 0 for success; always closes.
int write_all(int descriptor, const std::string& text, bool sync) {
  int error = 0;
  std::size_t written = 0;
  while (error == 0 && written < text.size()) {
    const ssize_t n = ::write(descriptor, text.data() + written, text.size() - written);
    if (n >= 0) {
      written += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (error == 0 && sync && ::fsync(descriptor) != 0) error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  return error;
}

// A file under its temporary name; removed unless `publish` was reached.
class PendingFile {
 public:
  PendingFile(const OutputFile& output, std::size_t i_file) {
    std::error_code error;
    const fs::path resolved = fs::weakly_canonical(output.file, error);  // through symbolic links
    target_ = error ? output.file : resolved;
    temporary_ = folder_of(target_) /
                 (".sopt-" + std::to_string(::getpid()) + '-' + std::to_string(i_file) + ".tmp");
    const int descriptor =
        ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(output.file, errno);
    const int write_error = write_all(descriptor, output.text, true);
    if (write_error != 0) {
      (void)::unlink(temporary_.c_str());
      fail(output.file, write_error);
    }
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  PendingFile(PendingFile&& other) noexcept
      : target_(std::move(other.target_)), temporary_(std::move(other.temporary_)) {
    other.temporary_.clear();
  }
  ~PendingFile() {
    if (!temporary_.empty()) (void)::unlink(temporary_.c_str());
  }

  void publish() {
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(target_, errno);
    temporary_.clear();
  }

 private:
  fs::path target_;
  fs::path temporary_;
};

}  // namespace

void check_outputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  std::error_code error;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const fs::path& output = outputs[i];
    const std::string shown = printable(output.string(), 400);
    if (output.filename().empty() || fs::is_directory(output, error)) {
      throw InputError(shown + ": is a directory; an output must be a file");
    }
    if (!fs::is_directory(folder_of(output), error)) {
      throw InputError(shown + ": folder " + printable(folder_of(output).string(), 400) +
                       " does not exist; an output must be in an existing folder");
    }
    if (is_special(output)) continue;
    for (const fs::path& input : inputs) {
      if (is_same(output, input)) {
        throw InputError(shown + ": is an input; an output must be another file");
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (is_same(output, outputs[j])) {
        throw InputError(shown + ": is asked for twice; outputs must be different files");
      }
    }
  }
}

void write_files(const std::vector<OutputFile>& files) {
  std::vector<PendingFile> pending;
  pending.reserve(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!is_special(files[i].file)) pending.emplace_back(files[i], i);
  }
  for (const OutputFile& output : files) {
    if (!is_special(output.file)) continue;
    const int descriptor = ::open(output.file.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) fail(output.file, errno);
    const int error = write_all(descriptor, output.text, false);
    if (error != 0) fail(output.file, error);
  }
  for (PendingFile& file : pending) file.publish();
}

}  // namespace sopt
