#include "opt/qp/sum_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {

template <class Base, class Arm>
SumRows<Base, Arm>::SumRows(Arena& arena, Base& base, Arm& arm,
                            const SumCapacity& capacity) noexcept
    : base_(&base),
      arm_(&arm),
      coupled_(arena, capacity.max_coupled),
      base_share_{{arena, capacity.max_active + 1},
                  {arena, capacity.max_active + 1},
                  {arena, capacity.max_active + 1}},
      arm_share_{{arena, capacity.max_active + 1},
                 {arena, capacity.max_active + 1},
                 {arena, capacity.max_active + 1}} {}

template <class Base, class Arm>
void SumRows<Base, Arm>::reset() SOPT_RT {
  first_arm_ = base_->num_ids();
  first_coupled_ = first_arm_ + arm_->num_ids();
  softness_ = 0;
  not_finite_ = 0;
  coupled_.clear();
}

template <class Base, class Arm>
bool SumRows<Base, Arm>::try_add(int base_constraint, int arm_id, Scalar bound) SOPT_RT {
  not_finite_ += Scalar(0) * bound;
  return coupled_.try_push_back(
      {base_constraint, base_->lower_id(base_constraint), arm_id, bound, bound});
}

template <class Base, class Arm>
bool SumRows<Base, Arm>::is_valid() const SOPT_RT {
  return base_->is_valid() && arm_->is_valid() && not_finite_ == Scalar(0);
}

template <class Base, class Arm>
typename SumRows<Base, Arm>::Parts SumRows<Base, Arm>::parts(int id) const SOPT_RT {
  if (id < first_arm_) return {id, -1};
  if (id < first_coupled_) return {-1, id - first_arm_};
  const Coupled& coupled = coupled_[id - first_coupled_];
  return {coupled.base_id, coupled.arm_id};
}

template <class Base, class Arm>
bool SumRows<Base, Arm>::is_free(int id) const SOPT_RT {
  if (id < first_arm_) return base_->is_free(id);
  if (id < first_coupled_) return arm_->is_free(id - first_arm_);
  return coupled_[id - first_coupled_].priced_bound > -std::numeric_limits<Scalar>::infinity();
}

template <class Base, class Arm>
void SumRows<Base, Arm>::enter(int id) SOPT_RT {
  const Parts p = parts(id);
  if (p.base >= 0) base_->enter(p.base);
  if (p.arm >= 0) arm_->enter(p.arm);
  if (id >= first_coupled_) {
    coupled_[id - first_coupled_].priced_bound = -std::numeric_limits<Scalar>::infinity();
  }
}

template <class Base, class Arm>
void SumRows<Base, Arm>::leave(int id) SOPT_RT {
  const Parts p = parts(id);
  if (p.base >= 0) base_->leave(p.base);
  if (p.arm >= 0) arm_->leave(p.arm);
  if (id >= first_coupled_) {
    Coupled& coupled = coupled_[id - first_coupled_];
    coupled.priced_bound = coupled.bound;
  }
}

template <class Base, class Arm>
void SumRows<Base, Arm>::gram(std::span<const int> ids, int id, Scalar* out) SOPT_RT {
  const Parts p = parts(id);
  split(ids);
  std::fill(out, out + ids.size(), Scalar(0));
  const auto add = [&](const auto& part, int part_id, Share& share) {
    part.gram(share.ids.span(), part_id, share.numbers.begin());
    for (int j = 0; j < share.ids.size(); ++j) out[share.positions[j]] += share.numbers[j];
  };
  if (p.base >= 0) add(*base_, p.base, base_share_);
  if (p.arm >= 0) add(*arm_, p.arm, arm_share_);
}

template <class Base, class Arm>
typename SumRows<Base, Arm>::Scalar SumRows<Base, Arm>::softness(int id) const SOPT_RT {
  if (id >= first_coupled_) return softness_;
  return id < first_arm_ ? base_->softness(id) : arm_->softness(id - first_arm_);
}

template <class Base, class Arm>
void SumRows<Base, Arm>::split(std::span<const int> ids) SOPT_RT {
  for (Share* share : {&base_share_, &arm_share_}) {
    share->ids.clear();
    share->positions.clear();
  }
  const auto push = [](Share& share, int id, int position) {
    (void)share.ids.try_push_back(id);
    (void)share.positions.try_push_back(position);
  };
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const Parts p = parts(ids[j]);
    if (p.base >= 0) push(base_share_, p.base, static_cast<int>(j));
    if (p.arm >= 0) push(arm_share_, p.arm, static_cast<int>(j));
  }
  for (Share* share : {&base_share_, &arm_share_}) {
    (void)share->numbers.try_resize(share->ids.size());
  }
}

template <class Base, class Arm>
void SumRows<Base, Arm>::split(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT {
  split(ids);
  for (Share* share : {&base_share_, &arm_share_}) {
    for (int j = 0; j < share->ids.size(); ++j) {
      share->numbers[j] = weights[static_cast<std::size_t>(share->positions[j])];
    }
  }
}

template <class Base, class Arm>
void SumRows<Base, Arm>::update_primal(std::span<const int> ids,
                                       std::span<const Scalar> weights) SOPT_RT {
  split(ids, weights);
  base_->update_primal(base_share_.ids.span(), base_share_.numbers.span());
  arm_->update_primal(arm_share_.ids.span(), arm_share_.numbers.span());
}

template <class Base, class Arm>
void SumRows<Base, Arm>::update_step(std::span<const int> ids,
                                     std::span<const Scalar> weights) SOPT_RT {
  split(ids, weights);
  base_->update_step(base_share_.ids.span(), base_share_.numbers.span());
  arm_->update_step(arm_share_.ids.span(), arm_share_.numbers.span());
}

template <class Base, class Arm>
typename SumRows<Base, Arm>::Scalar SumRows<Base, Arm>::step_value(int id) const SOPT_RT {
  const Parts p = parts(id);
  return (p.base >= 0 ? base_->step_value(p.base) : Scalar(0)) +
         (p.arm >= 0 ? arm_->step_value(p.arm) : Scalar(0));
}

template <class Base, class Arm>
void SumRows<Base, Arm>::add_step() SOPT_RT {
  base_->add_step();
  arm_->add_step();
}

template <class Base, class Arm>
typename SumRows<Base, Arm>::Scalar SumRows<Base, Arm>::violation(int id) const SOPT_RT {
  if (id < first_arm_) return base_->violation(id);
  if (id < first_coupled_) return arm_->violation(id - first_arm_);
  const Coupled& coupled = coupled_[id - first_coupled_];
  return coupled.bound - base_->value(coupled.base_constraint) - arm_->row_value(coupled.arm_id);
}

template <class Base, class Arm>
typename SumRows<Base, Arm>::Scalar SumRows<Base, Arm>::size_of_terms(int id) const SOPT_RT {
  if (id < first_arm_) return base_->size_of_terms(id);
  if (id < first_coupled_) return arm_->size_of_terms(id - first_arm_);
  const Coupled& coupled = coupled_[id - first_coupled_];
  return std::abs(coupled.bound) + std::abs(base_->value(coupled.base_constraint)) +
         std::abs(arm_->row_value(coupled.arm_id));
}

template <class Base, class Arm>
int SumRows<Base, Arm>::most_violated(Scalar tolerance) const SOPT_RT {
  int best = base_->most_violated(tolerance);
  Scalar worst = best >= 0 ? base_->violation(best) : tolerance;
  const int arm_best = arm_->most_violated(tolerance);
  if (arm_best >= 0 && arm_->violation(arm_best) > worst) {
    worst = arm_->violation(arm_best);
    best = first_arm_ + arm_best;
  }
  for (int i = 0; i < coupled_.size(); ++i) {
    const Coupled& coupled = coupled_[i];
    const Scalar violation = coupled.priced_bound - base_->value(coupled.base_constraint) -
                             arm_->row_value(coupled.arm_id);
    if (violation > worst) {
      worst = violation;
      best = first_coupled_ + i;
    }
  }
  return best;
}

template class SumRows<DenseRows<double>, KernelRows<double, 4>>;
template class SumRows<DenseRows<double>, KernelRows<double, 8>>;

}  // namespace sopt
