// Seeded families of segment QPs with the sizes, conditioning and active counts of segments as the
// optimiser meets them, for benchmarks and tests (H steps, m rows without input bounds, q active at
// the optimum with the equalities, least / median / most):
//     a  point in the plane, velocity input      H = 30  m  32 .. 92   cond(H)  38  q 17 / 29 / 38
//     b  arm of 5 joints, acceleration input     H = 30  m 215 .. 335  cond(H) 717  q 19 / 32 / 55
//     c  the same                                H = 20  m 145 .. 225  cond(H) 156  q 11 / 18 / 26
//     d  unicycle base with an arm of 4 joints   H = 30  m 187 .. 277  cond(H) 764  q 70 / 98 / 132
// Every problem comes with a partner as the next iteration of the optimiser would pose it: rows
// turned by 3 % and moved by 3 %, in d also the base linearised about a reference 3 % away. All are
// feasible: rows and bounds are laid around a reference trajectory that satisfies the dynamics.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/qp/segment_qp.h"

namespace sopt {

struct QpPair {
  std::string name;
  SegmentQp cold;
  SegmentQp warm;
  // Of arm rows: the same row's index in `warm`, -1: none. Empty: all rows and bounds are in the
  // same order, so that ids mean the same. Else there is no base.
  std::vector<int> warm_row_of{};
};

// Problems of the same order and weights.
struct QpFamily {
  std::string name;
  std::string description;
  std::vector<QpPair> pairs;
};

inline constexpr const char* kQpFamilies = "abcd";

// `name` is one of kQpFamilies.
[[nodiscard]] QpFamily make_qp_family(char name, int num_problems, std::uint64_t seed);

}  // namespace sopt
