#include "models/plane/broad_phase2.h"

namespace sopt {

bool BroadPhase2::build(std::span<const Aabb2> boxes) noexcept {
  // Slices of equal count along x, each sorted along y.
  return tree_.build(boxes, [this](int num_boxes) {
    const int num_leaves = divided_up(num_boxes, kTreeFanOut);
    const int num_slices = static_cast<int>(std::ceil(std::sqrt(num_leaves)));
    const int slice = divided_up(num_leaves, num_slices) * kTreeFanOut;
    tree_.sort_along(0, 0, num_boxes);
    for (int first = 0; first < num_boxes; first += slice) {
      tree_.sort_along(1, first, std::min(first + slice, num_boxes));
    }
  });
}

// Rounded outwards: center +- half must cover the box whatever the rounding.
void BroadPhase2::Node::set_box(int lane, const Aabb2& box) noexcept {
  const Vec2 center = 0.5 * (box.lower + box.upper);
  const Vec2 half = (box.upper - center).cwiseMax(center - box.lower) * (1.0 + 1e-12) +
                    Vec2::Constant(1e-12 * (1.0 + center.cwiseAbs().maxCoeff()));
  center_x[lane] = center.x();
  center_y[lane] = center.y();
  half_x[lane] = half.x();
  half_y[lane] = half.y();
}

}  // namespace sopt
