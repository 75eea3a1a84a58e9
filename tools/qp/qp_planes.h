// What the families of segment QPs are drawn from: smooth random signals, and the planes by which
// balls beside a reference path keep a trajectory on its side.
#pragma once

#include <vector>

#include "sampler/rng.h"

namespace sopt {

// Four waves with zero mean; `scale` is the size of the slowest.
[[nodiscard]] std::vector<double> next_signal(CounterRng& rng, int size, double scale);
[[nodiscard]] std::vector<double> next_direction(CounterRng& rng, int dimension);

struct ObstacleShape {
  double max_gap = 0.0;  // between reference and obstacle, over their centres' distance
  double min_distance = 0.0, max_distance = 0.0;  // of the centre
  int max_cover = 1;                              // times in a row that meet the same obstacle
};

// direction . (point - path[t]) >= -slack,   slack >= 0
struct Plane {
  int t = 0;
  std::vector<double> direction;
  double slack = 0.0;
  double distance = 0.0;  // from the obstacle's centre
};

// density x n planes at times 1 .. n - 1 of a path with n + 1 points, in time order.
[[nodiscard]] std::vector<Plane> next_planes(const ObstacleShape& shape,
                                             const std::vector<std::vector<double>>& path,
                                             int density, CounterRng& rng);

// As the next iteration sees them: turned by `change` radians at most, moved by `change` of the
// distance, still behind the path.
[[nodiscard]] std::vector<Plane> relinearised(std::vector<Plane> planes, double change,
                                              CounterRng& rng);

}  // namespace sopt
