// What stops a command of the program, by exit code. `what()` is the one line for stderr, without
// the program's name.
#pragma once

#include <stdexcept>
#include <string>

namespace sopt {

// A file that cannot be read, a field that is invalid, or wrong usage: exit code 2. The line names
// file, field, value and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The host refused memory or a write: exit code 3.
class HostError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sopt
