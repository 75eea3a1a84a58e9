#include "opt/qp/dense_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

template <class Scalar>
constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();

}  // namespace

template <class Scalar>
DenseRows<Scalar>::DenseRows(Arena& arena, const DenseCapacity& capacity) noexcept
    : stride_(padded<Scalar>(capacity.max_variables)),
      bounds_begin_(padded<Scalar>(capacity.max_rows)),
      max_rows_(capacity.max_rows),
      factor_(arena, capacity.max_variables),
      rows_(arena, bounds_begin_ * stride_),
      stretch_(arena, bounds_begin_ / kGroup),
      row_value_(arena, bounds_begin_),
      inverse_diagonal_(arena, stride_),
      price_(arena, bounds_begin_ + stride_),
      softness_(arena, bounds_begin_ + stride_),
      slot_(arena, 2 * (bounds_begin_ + stride_)),
      equalities_(arena, capacity.max_rows + capacity.max_variables),
      // Active rows, rows set aside, and the one that enters.
      y_(arena, (2 * capacity.max_active + 1) * stride_),
      free_slots_(arena, 2 * capacity.max_active + 1),
      base_(arena, stride_),
      x_(arena, stride_),
      step_(arena, stride_),
      scratch_(arena, stride_) {
  for (Sides* sides : {&lower_, &upper_}) {
    for (auto* numbers : {&sides->bound, &sides->priced_bound, &sides->scale}) {
      *numbers = {arena, bounds_begin_ + stride_};
      (void)numbers->try_resize(numbers->capacity());
    }
  }
  for (auto* numbers : {&rows_, &row_value_, &inverse_diagonal_, &price_, &softness_, &y_, &base_,
                        &x_, &step_, &scratch_}) {
    (void)numbers->try_resize(numbers->capacity());
  }
  (void)slot_.try_resize(slot_.capacity());
  for (int i = free_slots_.capacity() - 1; i >= 0; --i) (void)free_slots_.try_push_back(i);
}

template <class Scalar>
bool DenseRows<Scalar>::factorize(int num_variables, const Scalar* hessian) SOPT_RT {
  is_convex_ = factor_.factorize(num_variables, hessian);
  num_variables_ = factor_.size();
  for (int j = 0; j < num_variables_; ++j) {
    inverse_diagonal_[j] = Scalar(1) / hessian[j * num_variables + j];
  }
  return is_convex_;
}

template <class Scalar>
void DenseRows<Scalar>::reset(const Scalar* gradient) SOPT_RT {
  const int n = num_variables_;
  num_rows_ = 0;
  not_finite_ = 0;
  stretch_.clear();
  equalities_.clear();
  clear_constraints(bounds_begin_, bounds_begin_ + padded<Scalar>(n));
  std::fill(base_.begin(), base_.begin() + padded<Scalar>(n), Scalar(0));
  for (int i = 0; i < n; ++i) {
    not_finite_ += Scalar(0) * gradient[i];
    base_[i] = -gradient[i];
  }
  factor_.solve_lower(base_.begin(), 0);
}

template <class Scalar>
void DenseRows<Scalar>::clear_constraints(int first, int last) SOPT_RT {
  for (Sides* sides : {&lower_, &upper_}) {
    const Scalar never = sides == &lower_ ? -kInfinity<Scalar> : kInfinity<Scalar>;
    std::fill(sides->bound.begin() + first, sides->bound.begin() + last, never);
    std::fill(sides->priced_bound.begin() + first, sides->priced_bound.begin() + last, never);
    std::fill(sides->scale.begin() + first, sides->scale.begin() + last, Scalar(1));
  }
  std::fill(softness_.begin() + first, softness_.begin() + last, Scalar(0));
  std::fill(price_.begin() + first, price_.begin() + last, Scalar(0));
}

template <class Scalar>
bool DenseRows<Scalar>::try_add(const Scalar* a, Scalar lower, Scalar upper) SOPT_RT {
  const int n = num_variables_;
  if (num_rows_ == max_rows_) return false;
  if (num_rows_ % kGroup == 0) {
    (void)stretch_.try_push_back({n, 0});
    Scalar* const group = row(num_rows_);
    std::fill(group, group + kGroup * n, Scalar(0));
    clear_constraints(num_rows_, num_rows_ + kGroup);
  }
  Scalar* const stored = row(num_rows_);
  const Scalar* const inverse_diagonal = inverse_diagonal_.begin();
  Scalar length2 = 0;
  Scalar gram = 0;
  int first = n;
  int last = 0;
  for (int j = 0; j < n; ++j) {
    const Scalar square = a[j] * a[j];
    stored[kGroup * j] = a[j];
    length2 += square;
    gram += square * inverse_diagonal[j];
    const bool is_nonzero = a[j] != Scalar(0);
    first = is_nonzero ? std::min(first, j) : first;
    last = is_nonzero ? j + 1 : last;
  }
  Stretch& stretch = stretch_.back();
  stretch.first = std::min(stretch.first, first);
  stretch.last = std::max(stretch.last, last);
  not_finite_ += Scalar(0) * length2;
  ++num_rows_;
  set_constraint(num_rows_ - 1, lower, upper, std::sqrt(length2));
  set_price(num_rows_ - 1, gram);
  return true;
}

template <class Scalar>
void DenseRows<Scalar>::set_bounds(int variable, Scalar lower, Scalar upper) SOPT_RT {
  set_constraint(num_rows_ + variable, lower, upper, Scalar(1));
  set_price(num_rows_ + variable, inverse_diagonal_[variable]);
}

// By the estimate sum a_j^2 / H_jj of the row's gram entry, exact for a diagonal Hessian.
template <class Scalar>
void DenseRows<Scalar>::set_price(int constraint, Scalar gram) SOPT_RT {
  price_[position(constraint)] = gram > Scalar(0) ? Scalar(1) / gram : Scalar(1);
}

template <class Scalar>
void DenseRows<Scalar>::set_constraint(int constraint, Scalar lower, Scalar upper,
                                       Scalar length) SOPT_RT {
  const bool is_number = lower < kInfinity<Scalar> && upper > -kInfinity<Scalar>;
  if (!is_number) not_finite_ = std::numeric_limits<Scalar>::quiet_NaN();
  if (!(length > Scalar(0))) length = 1;
  const int p = position(constraint);
  for (Sides* sides : {&lower_, &upper_}) {
    const Scalar bound = sides == &lower_ ? lower : upper;
    const bool is_finite = std::abs(bound) < kInfinity<Scalar>;
    sides->bound[p] = sides->priced_bound[p] = bound;
    sides->scale[p] = is_finite ? Scalar(1) / std::max(length, std::abs(bound)) : Scalar(1);
  }
  forget_equality(constraint);
  if (lower == upper) {
    (void)equalities_.try_push_back(constraint);
    lower_.priced_bound[p] = -kInfinity<Scalar>;
    upper_.priced_bound[p] = kInfinity<Scalar>;
  }
}

// Bounds of a variable may be set anew.
template <class Scalar>
void DenseRows<Scalar>::forget_equality(int constraint) SOPT_RT {
  auto* const known = std::find(equalities_.begin(), equalities_.end(), constraint);
  if (known == equalities_.end()) return;
  std::copy(known + 1, equalities_.end(), known);
  (void)equalities_.try_resize(equalities_.size() - 1);
}

template <class Scalar>
void DenseRows<Scalar>::set_softness(int constraint, Scalar softness) SOPT_RT {
  softness_[position(constraint)] = softness;
}

template <class Scalar>
bool DenseRows<Scalar>::is_free(int id) const SOPT_RT {
  const int p = position(constraint(id));
  return is_upper(id) ? upper_.priced_bound[p] < kInfinity<Scalar>
                      : lower_.priced_bound[p] > -kInfinity<Scalar>;
}

template <class Scalar>
void DenseRows<Scalar>::enter(int id) SOPT_RT {
  const int n = num_variables_;
  const int c = constraint(id);
  if (is_upper(id)) {
    upper_.priced_bound[position(c)] = kInfinity<Scalar>;
  } else {
    lower_.priced_bound[position(c)] = -kInfinity<Scalar>;
  }
  slot(id) = free_slots_.back();
  (void)free_slots_.try_resize(free_slots_.size() - 1);
  Scalar* const y = y_.begin() + slot(id) * stride_;
  const Scalar factor = scale(id);
  std::fill(y, y + padded<Scalar>(n), Scalar(0));
  if (c < num_rows_) {
    const Stretch& stretch = stretch_[c / kGroup];
    const Scalar* const a = row(c);
    for (int j = stretch.first; j < stretch.last; ++j) y[j] = factor * a[kGroup * j];
    factor_.solve_lower(y, std::min(stretch.first, n));
  } else {
    y[c - num_rows_] = factor;
    factor_.solve_lower(y, c - num_rows_);
  }
}

template <class Scalar>
void DenseRows<Scalar>::leave(int id) SOPT_RT {
  (void)free_slots_.try_push_back(slot(id));
  if (id < num_equalities()) return;
  Sides& sides = is_upper(id) ? upper_ : lower_;
  const int p = position(constraint(id));
  sides.priced_bound[p] = sides.bound[p];
}

template <class Scalar>
void DenseRows<Scalar>::gram(std::span<const int> ids, int id, Scalar* out) const SOPT_RT {
  const int n = padded<Scalar>(num_variables_);
  const Scalar* const y = y_of(id);
  std::size_t j = 0;
  for (; j + 4 <= ids.size(); j += 4) {
    const Scalar* const others[4] = {y_of(ids[j]), y_of(ids[j + 1]), y_of(ids[j + 2]),
                                     y_of(ids[j + 3])};
    dot4(others, y, n, out + j);
  }
  for (; j < ids.size(); ++j) out[j] = dot(y_of(ids[j]), y, n);
}

// sum += sum of w_i y_i
template <class Scalar>
void DenseRows<Scalar>::add_rows(std::span<const int> ids, std::span<const Scalar> weights,
                                 Scalar* sum) const SOPT_RT {
  const int n = padded<Scalar>(num_variables_);
  std::size_t j = 0;
  for (; j + 4 <= ids.size(); j += 4) {
    const Scalar* const rows[4] = {y_of(ids[j]), y_of(ids[j + 1]), y_of(ids[j + 2]),
                                   y_of(ids[j + 3])};
    const Scalar w[4] = {weights[j], weights[j + 1], weights[j + 2], weights[j + 3]};
    add_scaled4(w, rows, sum, n);
  }
  for (; j < ids.size(); ++j) add_scaled(weights[j], y_of(ids[j]), sum, n);
}

template <class Scalar>
void DenseRows<Scalar>::update_primal(std::span<const int> ids,
                                      std::span<const Scalar> weights) SOPT_RT {
  std::copy(base_.begin(), base_.begin() + padded<Scalar>(num_variables_), x_.begin());
  add_rows(ids, weights, x_.begin());
  factor_.solve_upper(x_.begin());
  update_row_values();
}

template <class Scalar>
void DenseRows<Scalar>::update_step(std::span<const int> ids,
                                    std::span<const Scalar> weights) SOPT_RT {
  std::fill(step_.begin(), step_.begin() + padded<Scalar>(num_variables_), Scalar(0));
  add_rows(ids, weights, step_.begin());
}

template <class Scalar>
Scalar DenseRows<Scalar>::step_value(int id) const SOPT_RT {
  return dot(y_of(id), step_.begin(), padded<Scalar>(num_variables_));
}

template <class Scalar>
Scalar DenseRows<Scalar>::step_energy() const SOPT_RT {
  return dot(step_.begin(), step_.begin(), padded<Scalar>(num_variables_));
}

template <class Scalar>
void DenseRows<Scalar>::add_step() SOPT_RT {
  const int n = padded<Scalar>(num_variables_);
  std::copy(step_.begin(), step_.begin() + n, scratch_.begin());
  factor_.solve_upper(scratch_.begin());
  add_scaled(Scalar(1), scratch_.begin(), x_.begin(), n);
  update_row_values();
}

template <class Scalar>
void DenseRows<Scalar>::update_row_values() SOPT_RT {
  for (int g = 0; g < stretch_.size(); ++g) {
    const Stretch& stretch = stretch_[g];
    const Scalar* const group = rows_.begin() + g * kGroup * stride_;
    typename VectorOf<Scalar>::Type even{};
    typename VectorOf<Scalar>::Type odd{};
    int j = stretch.first;
    for (; j + 2 <= stretch.last; j += 2) {
      even += load_vector(group + kGroup * j) * x_[j];
      odd += load_vector(group + kGroup * (j + 1)) * x_[j + 1];
    }
    if (j < stretch.last) even += load_vector(group + kGroup * j) * x_[j];
    store_vector<Scalar>(even + odd, row_value_.begin() + kGroup * g);
  }
}

template <class Scalar>
Scalar DenseRows<Scalar>::violation(int id) const SOPT_RT {
  const Sides& sides = is_upper(id) ? upper_ : lower_;
  const int c = constraint(id);
  return scale(id) * (sides.bound[position(c)] - value(c));
}

template <class Scalar>
Scalar DenseRows<Scalar>::size_of_terms(int id) const SOPT_RT {
  const int c = constraint(id);
  const Sides& sides = is_upper(id) ? upper_ : lower_;
  Scalar size = std::abs(sides.bound[position(c)]);
  if (c >= num_rows_) return std::abs(scale(id)) * (size + std::abs(x_[c - num_rows_]));
  const Scalar* const a = row(c);
  for (int j = 0; j < num_variables_; ++j) size += std::abs(a[kGroup * j] * x_[j]);
  return std::abs(scale(id)) * size;
}

template <class Scalar>
int DenseRows<Scalar>::most_violated(Scalar tolerance) const SOPT_RT {
  using Vector = typename VectorOf<Scalar>::Type;
  Vector worst{};
  Vector worst_at = Vector{} - Scalar(1);
  const auto price = [&](int p, const Vector& value) {
    const Vector below = load_vector(&lower_.priced_bound[p]) - value;
    const Vector above = value - load_vector(&upper_.priced_bound[p]);
    const Vector violated_below =
        below * load_vector(&lower_.scale[p]) > tolerance ? below : Vector{};
    const Vector violated_above =
        above * load_vector(&upper_.scale[p]) > tolerance ? above : Vector{};
    const Vector violated = violated_below > violated_above ? violated_below : violated_above;
    const Vector excess = violated * violated * load_vector(&price_[p]);
    worst_at = excess > worst ? Vector{} + static_cast<Scalar>(p) : worst_at;
    worst = excess > worst ? excess : worst;
  };
  for (int c = 0; c < num_rows_; c += kGroup) price(c, load_vector(&row_value_[c]));
  for (int j = 0; j < num_variables_; j += kGroup) price(bounds_begin_ + j, load_vector(&x_[j]));
  int best = -1;
  for (int lane = 0; lane < kGroup; ++lane) {
    if (worst_at[lane] < Scalar(0)) continue;
    const int p = static_cast<int>(worst_at[lane]) + lane;
    const bool is_worse = best < 0 || worst[lane] > worst[best % kGroup];
    if (is_worse || (worst[lane] == worst[best % kGroup] && p < best)) best = p;
  }
  return best < 0 ? -1 : violated_side(best);
}

// Id of the side that is violated more, of the constraint at position p.
template <class Scalar>
int DenseRows<Scalar>::violated_side(int p) const SOPT_RT {
  const int c = p < bounds_begin_ ? p : p - bounds_begin_ + num_rows_;
  const Scalar above = (value(c) - upper_.priced_bound[p]) * upper_.scale[p];
  const Scalar below = (lower_.priced_bound[p] - value(c)) * lower_.scale[p];
  return lower_id(c) + (above > below ? 1 : 0);
}

template <class Scalar>
void DenseRows<Scalar>::write_multipliers(std::span<const int> ids,
                                          std::span<const Scalar> multipliers,
                                          Scalar* out) const SOPT_RT {
  std::fill(out, out + num_rows_ + num_variables_, Scalar(0));
  for (std::size_t j = 0; j < ids.size(); ++j) {
    out[constraint(ids[j])] += multipliers[j] * scale(ids[j]);
  }
}

template class DenseRows<double>;
template class DenseRows<float>;

}  // namespace sopt
