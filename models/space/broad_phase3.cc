#include "models/space/broad_phase3.h"

#include <cmath>

namespace sopt {

bool BroadPhase3::build(std::span<const Aabb3> boxes) noexcept {
  // Slabs of equal count along x, each cut into bars along y, each sorted along z.
  return tree_.build(boxes, [this](int num_boxes) {
    const int num_leaves = divided_up(num_boxes, kTreeFanOut);
    const int num_slabs = static_cast<int>(std::ceil(std::cbrt(num_leaves)));
    const int bar = divided_up(num_leaves, num_slabs * num_slabs) * kTreeFanOut;
    const int slab = num_slabs * bar;
    tree_.sort_along(0, 0, num_boxes);
    for (int first = 0; first < num_boxes; first += slab) {
      const int last = std::min(first + slab, num_boxes);
      tree_.sort_along(1, first, last);
      for (int i = first; i < last; i += bar) tree_.sort_along(2, i, std::min(i + bar, last));
    }
  });
}

// With room for the rounding of whoever computes the box of a query.
void BroadPhase3::Node::set_box(int lane, const Aabb3& box) noexcept {
  const double room =
      1e-12 * (1.0 + box.lower.cwiseAbs().maxCoeff() + box.upper.cwiseAbs().maxCoeff());
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis][lane] = box.lower[axis] - room;
    upper[axis][lane] = box.upper[axis] + room;
  }
}

}  // namespace sopt
