// JSON as text for files that must be read back bit by bit: numbers with 17 significant digits,
// numbers that are not finite as null. The fields of the outermost object stand on lines of their
// own, everything below is compact; arrays of arrays have one element per line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sopt {

[[nodiscard]] std::string to_text(const nlohmann::ordered_json& document);

}  // namespace sopt
