#include "tools/qp/qp_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace sopt {
namespace {

using Vector = std::vector<double>;
using Path = std::vector<Vector>;

constexpr double kPi = 3.14159265358979323846;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Sum of uniform numbers: mean 0, variance 1, and the same on every platform.
double next_gaussian(CounterRng& rng) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += rng.next_uniform();
  return sum;
}

double next_between(CounterRng& rng, double low, double high) {
  return low + (high - low) * rng.next_uniform();
}

void normalise(Vector& v) {
  const double length = std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
  for (double& x : v) x /= length;
}

// Of a ball beside the path, tangent planes facing the times first .. last.
void append_obstacle(const ObstacleShape& shape, const Path& path, int first, int last,
                     CounterRng& rng, std::vector<Plane>& planes) {
  const Vector& beside = path[at((first + last) / 2)];
  Vector centre = next_direction(rng, static_cast<int>(beside.size()));
  const double distance = next_between(rng, shape.min_distance, shape.max_distance);
  for (std::size_t j = 0; j < centre.size(); ++j) centre[j] = beside[j] - distance * centre[j];
  const double gap = next_between(rng, 0.0, shape.max_gap);
  const std::size_t begin = planes.size();
  double nearest = distance;
  for (int t = first; t <= last; ++t) {
    Plane plane;
    plane.t = t;
    double length2 = 0.0;
    for (std::size_t j = 0; j < centre.size(); ++j) {
      plane.direction.push_back(path[at(t)][j] - centre[j]);
      length2 += plane.direction[j] * plane.direction[j];
    }
    plane.distance = std::sqrt(length2);
    normalise(plane.direction);
    nearest = std::min(nearest, plane.distance);
    planes.push_back(plane);
  }
  for (std::size_t i = begin; i < planes.size(); ++i) {
    planes[i].slack = planes[i].distance - (1.0 - gap) * nearest;
  }
}

}  // namespace

Vector next_direction(CounterRng& rng, int dimension) {
  Vector v(at(dimension));
  for (double& x : v) x = next_gaussian(rng);
  normalise(v);
  return v;
}

Vector next_signal(CounterRng& rng, int size, double scale) {
  Vector signal(at(size), 0.0);
  for (int k = 1; k <= 4; ++k) {
    const double amplitude = scale * next_gaussian(rng) / k;
    for (int t = 0; t < size; ++t) {
      signal[at(t)] += amplitude * std::cos(kPi * k * (t + 0.5) / size);
    }
  }
  return signal;
}

// A layer has n planes: its first two obstacles share a time.
std::vector<Plane> next_planes(const ObstacleShape& shape, const Path& path, int density,
                               CounterRng& rng) {
  const int end = static_cast<int>(path.size()) - 1;
  std::vector<Plane> planes;
  for (int layer = 0; layer < density; ++layer) {
    int first = 1;
    for (int obstacle = 0; first < end; ++obstacle) {
      const auto cover = static_cast<int>(shape.max_cover * rng.next_uniform());
      const int last = std::min(first + cover, end - 1);
      append_obstacle(shape, path, first, last, rng, planes);
      first = obstacle == 0 ? last : last + 1;
    }
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const Plane& a, const Plane& b) { return a.t < b.t; });
  return planes;
}

std::vector<Plane> relinearised(std::vector<Plane> planes, double change, CounterRng& rng) {
  for (Plane& plane : planes) {
    const Vector turn = next_direction(rng, static_cast<int>(plane.direction.size()));
    for (std::size_t j = 0; j < turn.size(); ++j) plane.direction[j] += change * turn[j];
    normalise(plane.direction);
    plane.slack = std::max(0.0, plane.slack + change * plane.distance * next_gaussian(rng));
  }
  return planes;
}

}  // namespace sopt
