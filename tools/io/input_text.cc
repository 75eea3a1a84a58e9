#include "tools/io/input_text.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"

namespace sopt {

std::string read_input(const std::filesystem::path& file, const char* allowed) {
  const std::string shown = printable(file.string(), 400);
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(status)) {
    throw InputError(shown + ": is a directory; it must be " + allowed);
  }
  const std::string limit =
      "; it must be at most " + std::to_string(kMaxInputSize_B >> 20U) + " MiB";
  if (std::filesystem::is_regular_file(status)) {
    const std::uintmax_t size_B = std::filesystem::file_size(file, error);
    if (!error && size_B > kMaxInputSize_B) {
      throw InputError(shown + ": is " + std::to_string(size_B >> 20U) + " MiB" + limit);
    }
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw InputError(shown + ": cannot be read: " + std::strerror(errno == 0 ? EIO : errno));
  }
  std::string text;
  std::vector<char> chunk(std::size_t{1} << 16U);
  while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || in.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMaxInputSize_B) throw InputError(shown + ": is larger than allowed" + limit);
  }
  if (in.bad()) throw InputError(shown + ": cannot be read: " + std::strerror(EIO));
  return text;
}

}  // namespace sopt
