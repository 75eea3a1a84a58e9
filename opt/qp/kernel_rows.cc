#include "opt/qp/kernel_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

// A bound that always holds; finite, so that its product with a price is a number.
template <class Scalar>
constexpr Scalar kFar = Scalar(1e30);

}  // namespace

template <class Scalar, int kLanes>
KernelRows<Scalar, kLanes>::KernelRows(Arena& arena, const IntegratorKernel<Scalar>& kernel,
                                       const KernelCapacity& capacity) noexcept
    : kernel_(&kernel), row_ids_(arena, capacity.max_rows) {
  const int profile = kernel.profile_size(capacity.max_window);
  // Every quantity and time may have one group that is not full.
  const int num_groups = capacity.max_rows / kGroup + profile;
  groups_ = {arena, num_groups};
  group_index_ = {arena, num_groups};
  row_value_ = {arena, kGroup * num_groups};
  for (auto* bounds : {&lower_, &upper_}) {
    *bounds = {arena, kLanes * profile};
    (void)bounds->try_resize(bounds->capacity());
  }
  for (auto* values : {&force_, &value_, &step_}) {
    *values = {arena, kLanes * profile};
    (void)values->try_resize(values->capacity());
    std::fill(values->begin(), values->end(), Scalar(0));
  }
  // Active rows, rows set aside, and the one that enters.
  const int num_slots = 2 * capacity.max_active + 1;
  entered_ = {arena, num_slots};
  (void)entered_.try_resize(entered_.capacity());
  free_slots_ = {arena, num_slots};
  for (int i = free_slots_.capacity() - 1; i >= 0; --i) (void)free_slots_.try_push_back(i);
  slot_ = {arena, kGroup * num_groups + 2 * kLanes * profile};
  (void)slot_.try_resize(slot_.capacity());
  std::fill(slot_.begin(), slot_.end(), -1);
  if (capacity.max_window > kernel.max_table()) {
    columns_ = {arena, num_slots * profile};
    (void)columns_.try_resize(columns_.capacity());
    own_end_response_ = {arena, kernel.order() * profile};
    (void)own_end_response_.try_resize(own_end_response_.capacity());
    own_price_ = {arena, profile};
    (void)own_price_.try_resize(own_price_.capacity());
    std::fill(own_price_.begin(), own_price_.end(), Scalar(1));
  }
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::reset(const KernelSegment<Scalar>& segment) SOPT_RT {
  num_steps_ = segment.num_steps;
  num_joints_ = segment.num_joints;
  softness_ = 0;
  not_finite_ = 0;
  groups_.clear();
  group_index_.clear();
  row_value_.clear();
  row_ids_.clear();
  std::fill(std::begin(has_bounds_), std::end(has_bounds_), false);
  if (num_steps_ < kernel_->order() || kLanes * kernel_->profile_size(num_steps_) > value_.size() ||
      num_joints_ < 1 || num_joints_ > kLanes) {
    not_finite_ = std::numeric_limits<Scalar>::quiet_NaN();
    num_steps_ = 0;
    num_joints_ = 0;
    profile_size_ = 0;
    return;
  }
  profile_size_ = kernel_->profile_size(num_steps_);
  const auto load = [&](const Scalar* from, Scalar otherwise) {
    Joints joints{};
    for (int j = 0; j < num_joints_; ++j) {
      const Scalar value = from == nullptr ? otherwise : from[j];
      joints.set(j, value);
      not_finite_ += Scalar(0) * value;
    }
    return joints;
  };
  ends_.first_position = load(segment.first_position, 0);
  ends_.last_position = load(segment.last_position, 0);
  ends_.first_velocity = load(segment.first_velocity, 0);
  ends_.last_velocity = load(segment.last_velocity, 0);
  ends_.attractor = load(segment.attractor, 0);
  factors_ = load(segment.factors, 1);
  Scalar r[kLanes];
  factors_.store(r);
  for (int j = 0; j < kLanes; ++j) {
    const bool is_joint = j < num_joints_;
    if (is_joint && !(r[j] > Scalar(0))) not_finite_ = std::numeric_limits<Scalar>::quiet_NaN();
    inverse_factor_[j] = is_joint ? Scalar(1) / r[j] : Scalar(0);
    joint_price_.set(j, is_joint ? std::sqrt(r[j]) : Scalar(0));
  }
  load_kernel();
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::load_kernel() SOPT_RT {
  const int n = num_steps_;
  has_table_ = n <= kernel_->max_table();
  if (!has_table_) {
    kernel_->compute_end_response(n, own_end_response_.begin());
    end_response_ = own_end_response_.begin();
    price_ = own_price_.begin();
    return;
  }
  end_response_ = kernel_->table_end_response(n);
  price_ = kernel_->table_price(n);
}

template <class Scalar, int kLanes>
bool KernelRows<Scalar, kLanes>::try_add(Quantity quantity, int t, const Scalar* direction,
                                         Scalar bound) SOPT_RT {
  if (profile_size_ == 0) return true;
  const int index = index_of(quantity, t);
  if (row_ids_.size() == row_ids_.capacity()) return false;
  const bool fits = num_in_group_ < kGroup && !groups_.empty() && group_index_.back() == index;
  if (!fits && !try_begin_group(index)) return false;
  Group& group = groups_.back();
  const int place = num_in_group_++;
  Scalar norm2 = 0;
  for (int j = 0; j < num_joints_; ++j) {
    group.direction[j][place] = direction[j];
    norm2 += direction[j] * direction[j] * inverse_factor_[j];
  }
  // No bound at all is fine.
  const Scalar checked = bound == -std::numeric_limits<Scalar>::infinity() ? Scalar(0) : bound;
  not_finite_ += Scalar(0) * (norm2 + checked);
  group.priced_bound[place] = std::max(bound, -kFar<Scalar>);
  group.price[place] = norm2 > Scalar(0) ? price_[index] / std::sqrt(norm2) : Scalar(1);
  (void)row_ids_.try_push_back(num_padded() - kGroup + place);
  return true;
}

// Opens a group whose rows hold until they are filled in.
template <class Scalar, int kLanes>
bool KernelRows<Scalar, kLanes>::try_begin_group(int index) SOPT_RT {
  if (!groups_.try_resize(groups_.size() + 1)) return false;
  (void)group_index_.try_push_back(index);
  (void)row_value_.try_resize(num_padded());
  Group& group = groups_.back();
  std::fill_n(&group.direction[0][0], kLanes * kGroup, Scalar(0));
  std::fill_n(group.priced_bound, kGroup, -kFar<Scalar>);
  std::fill_n(group.price, kGroup, Scalar(0));
  num_in_group_ = 0;
  return true;
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::set_bounds(Quantity quantity, int first_t, int last_t,
                                            const Scalar* lower, const Scalar* upper) SOPT_RT {
  if (profile_size_ == 0) return;
  constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();
  const int begin = kLanes * index_of(quantity, 0);
  bool& has_bounds = has_bounds_[static_cast<int>(quantity)];
  if (!has_bounds) {
    const int size = kLanes * (num_steps_ + 1);
    std::fill_n(lower_.begin() + begin, size, -kFar<Scalar>);
    std::fill_n(upper_.begin() + begin, size, kFar<Scalar>);
    has_bounds = true;
  }
  Scalar low[kLanes], high[kLanes];
  std::fill_n(low, kLanes, -kFar<Scalar>);
  std::fill_n(high, kLanes, kFar<Scalar>);
  for (int j = 0; j < num_joints_; ++j) {
    if (!(lower[j] < kInfinity) || !(upper[j] > -kInfinity)) {
      not_finite_ = std::numeric_limits<Scalar>::quiet_NaN();
    }
    low[j] = std::max(lower[j], -kFar<Scalar>);
    high[j] = std::min(upper[j], kFar<Scalar>);
  }
  const Joints low_joints = Joints::load(low);
  const Joints high_joints = Joints::load(high);
  for (int t = first_t; t <= last_t; ++t) {
    low_joints.store(lower_.begin() + begin + kLanes * t);
    high_joints.store(upper_.begin() + begin + kLanes * t);
  }
}

// What the row must keep, one-sided.
template <class Scalar, int kLanes>
Scalar KernelRows<Scalar, kLanes>::bound_of(int id) const SOPT_RT {
  if (slot_[id] >= 0) return entered_[slot_[id]].bound;
  if (id < num_padded()) return groups_[id / kGroup].priced_bound[id % kGroup];
  const int i = (id - num_padded()) / 2;
  return (id - num_padded()) % 2 == 1 ? -upper_[i] : lower_[i];
}

template <class Scalar, int kLanes>
typename KernelRows<Scalar, kLanes>::Row KernelRows<Scalar, kLanes>::row_of(int id) const SOPT_RT {
  Row row;
  row.bound = bound_of(id);
  if (id < num_padded()) {
    const Group& group = groups_[id / kGroup];
    row.index = group_index_[id / kGroup];
    for (int j = 0; j < num_joints_; ++j) row.direction.set(j, group.direction[j][id % kGroup]);
    return row;
  }
  const int i = (id - num_padded()) / 2;
  const bool is_upper = (id - num_padded()) % 2 == 1;
  row.index = i / kLanes;
  row.direction.set(i % kLanes, is_upper ? Scalar(-1) : Scalar(1));
  return row;
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::set_priced_bound(int id, Scalar bound) SOPT_RT {
  if (id < num_padded()) {
    groups_[id / kGroup].priced_bound[id % kGroup] = bound;
    return;
  }
  const int i = (id - num_padded()) / 2;
  if ((id - num_padded()) % 2 == 1) {
    upper_[i] = -bound;
  } else {
    lower_[i] = bound;
  }
}

template <class Scalar, int kLanes>
bool KernelRows<Scalar, kLanes>::is_free(int id) const SOPT_RT {
  if (id < num_padded()) {
    return groups_[id / kGroup].priced_bound[id % kGroup] > -kFar<Scalar>;
  }
  const int i = (id - num_padded()) / 2;
  const int quantity = i / (kLanes * (num_steps_ + 1));
  if (!has_bounds_[quantity]) return false;
  return (id - num_padded()) % 2 == 1 ? upper_[i] < kFar<Scalar> : lower_[i] > -kFar<Scalar>;
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::enter(int id) SOPT_RT {
  const int slot = free_slots_.back();
  (void)free_slots_.try_resize(free_slots_.size() - 1);
  const Row row = row_of(id);
  slot_[id] = slot;
  Entered& entered = entered_[slot];
  entered.index = row.index;
  entered.direction = row.direction;
  entered.weighted = row.direction * Joints::load(inverse_factor_);
  entered.bound = row.bound;
  if (has_table_) {
    entered.column = kernel_->table_column(num_steps_, row.index);
  } else {
    Scalar* const column = columns_.begin() + slot * profile_size_;
    kernel_->compute_column(num_steps_, row.index, end_response_, column);
    entered.column = column;
  }
  set_priced_bound(id, -kFar<Scalar>);
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::leave(int id) SOPT_RT {
  set_priced_bound(id, entered_[slot_[id]].bound);
  (void)free_slots_.try_push_back(slot_[id]);
  slot_[id] = -1;
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::gram(std::span<const int> ids, int id, Scalar* out) const SOPT_RT {
  const Entered& a = entered_[slot_[id]];
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const Entered& b = entered_[slot_[ids[j]]];
    out[j] = a.column[b.index] * a.direction.dot(b.weighted);
  }
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::add_forces(std::span<const int> ids,
                                            std::span<const Scalar> weights) SOPT_RT {
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const Entered& entered = entered_[slot_[ids[j]]];
    Scalar* const force = force_.begin() + kLanes * entered.index;
    (Joints::load(force) + entered.weighted * weights[j]).store(force);
  }
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::update_primal(std::span<const int> ids,
                                               std::span<const Scalar> weights) SOPT_RT {
  add_forces(ids, weights);
  kernel_->template sweep<kLanes>(num_steps_, ends_, end_response_, force_.begin(), value_.begin());
  update_row_values();
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::update_row_values() SOPT_RT {
  for (int g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const Scalar* const value = value_.begin() + kLanes * group_index_[g];
    auto sum = load_vector(group.direction[0]) * value[0];
    for (int j = 1; j < num_joints_; ++j) sum += load_vector(group.direction[j]) * value[j];
    store_vector<Scalar>(sum, row_value_.begin() + kGroup * g);
  }
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::update_step(std::span<const int> ids,
                                             std::span<const Scalar> weights) SOPT_RT {
  add_forces(ids, weights);
  kernel_->template sweep<kLanes>(num_steps_, {}, end_response_, force_.begin(), step_.begin());
}

template <class Scalar, int kLanes>
Scalar KernelRows<Scalar, kLanes>::step_value(int id) const SOPT_RT {
  const Entered& entered = entered_[slot_[id]];
  return entered.direction.dot(Joints::load(step_.begin() + kLanes * entered.index));
}

template <class Scalar, int kLanes>
Scalar KernelRows<Scalar, kLanes>::step_energy() const SOPT_RT {
  Joints sum{};
  for (int quantity = 0; quantity <= kernel_->order(); ++quantity) {
    Joints squares{};
    const Scalar* const step = step_.begin() + kLanes * quantity * (num_steps_ + 1);
    for (int t = 0; t < num_steps_; ++t) {
      const Joints value = Joints::load(step + kLanes * t);
      squares += value * value;
    }
    sum += squares * kernel_->weight(quantity);
  }
  return sum.dot(factors_);
}

template <class Scalar, int kLanes>
void KernelRows<Scalar, kLanes>::add_step() SOPT_RT {
  add_scaled(Scalar(1), step_.begin(), value_.begin(), kLanes * profile_size_);
  update_row_values();
}

template <class Scalar, int kLanes>
Scalar KernelRows<Scalar, kLanes>::violation(int id) const SOPT_RT {
  if (id < num_padded()) return bound_of(id) - row_value_[id];
  const Scalar value = value_[(id - num_padded()) / 2];
  return bound_of(id) + ((id - num_padded()) % 2 == 1 ? value : -value);
}

template <class Scalar, int kLanes>
Scalar KernelRows<Scalar, kLanes>::size_of_terms(int id) const SOPT_RT {
  const Row row = row_of(id);
  Scalar direction[kLanes];
  row.direction.store(direction);
  Scalar size = std::abs(row.bound);
  for (int j = 0; j < kLanes; ++j) {
    size += std::abs(direction[j] * value_[kLanes * row.index + j]);
  }
  return size;
}

template <class Scalar, int kLanes>
int KernelRows<Scalar, kLanes>::most_violated(Scalar tolerance) const SOPT_RT {
  using Vector = typename VectorOf<Scalar>::Type;
  Vector worst{};
  Vector worst_group = Vector{} - Scalar(1);
  for (int g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const Vector excess = (load_vector(group.priced_bound) - tolerance -
                           load_vector(row_value_.begin() + kGroup * g)) *
                          load_vector(group.price);
    worst_group = excess > worst ? Vector{} + static_cast<Scalar>(g) : worst_group;
    worst = excess > worst ? excess : worst;
  }
  int best = -1;
  Scalar best_value = 0;
  for (int lane = 0; lane < kGroup; ++lane) {
    const int id = static_cast<int>(worst_group[lane]) * kGroup + lane;
    if (worst[lane] > best_value || (worst[lane] == best_value && best >= 0 && id < best)) {
      best_value = worst[lane];
      best = id;
    }
  }
  return most_violated_bound(tolerance, best, best_value);
}

// The bound that is violated by more than `best_value` in the pricing scale, or else `best`.
template <class Scalar, int kLanes>
int KernelRows<Scalar, kLanes>::most_violated_bound(Scalar tolerance, int best,
                                                    Scalar best_value) const SOPT_RT {
  using Part = typename Joints::Part;
  constexpr int kWidth = Joints::kWidth;
  Part worst[Joints::kParts] = {};
  Part worst_index[Joints::kParts] = {};
  for (int quantity = 0; quantity <= kernel_->order(); ++quantity) {
    if (!has_bounds_[quantity]) continue;
    const int begin = quantity * (num_steps_ + 1);
    for (int i = begin; i <= begin + num_steps_; ++i) {
      for (int part = 0; part < Joints::kParts; ++part) {
        const int at = kLanes * i + kWidth * part;
        const Part value = load_vector(value_.begin() + at);
        const Part below = load_vector(lower_.begin() + at) - value;
        const Part above = value - load_vector(upper_.begin() + at);
        const Part excess =
            ((below > above ? below : above) - tolerance) * price_[i] * joint_price_.part[part];
        worst_index[part] =
            excess > worst[part] ? Part{} + static_cast<Scalar>(i) : worst_index[part];
        worst[part] = excess > worst[part] ? excess : worst[part];
      }
    }
  }
  for (int joint = 0; joint < num_joints_; ++joint) {
    const Scalar excess = worst[joint / kWidth][joint % kWidth];
    if (!(excess > best_value)) continue;
    best_value = excess;
    const int at = kLanes * static_cast<int>(worst_index[joint / kWidth][joint % kWidth]) + joint;
    const bool is_upper = value_[at] - upper_[at] > lower_[at] - value_[at];
    best = num_padded() + 2 * at + (is_upper ? 1 : 0);
  }
  return best;
}

template class KernelRows<double, 4>;
template class KernelRows<double, 8>;
template class KernelRows<float, 8>;

}  // namespace sopt
