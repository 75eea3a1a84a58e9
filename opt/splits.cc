#include "opt/splits.h"

#include <algorithm>

namespace sopt {

Splits::Splits(Arena& arena, int max_horizon) noexcept
    : indices_(arena, max_horizon + 1), is_pinned_(arena, max_horizon + 1) {}

bool Splits::try_reset(int horizon, int num_segments) SOPT_RT {
  indices_.clear();
  is_pinned_.clear();
  const std::int64_t num_splits = 2 * static_cast<std::int64_t>(num_segments);
  for (std::int64_t j = 0; j <= num_splits; ++j) {
    // round(j H / 2N) in integers, halves up
    const int index = static_cast<int>((2 * j * horizon + num_splits) / (2 * num_splits));
    if (!indices_.empty() && indices_.back() == index) continue;
    if (!indices_.try_push_back(index) || !is_pinned_.try_push_back(false)) return false;
  }
  return true;
}

void Splits::list_windows(Parity parity, FixedVector<Window>& windows) const SOPT_RT {
  windows.clear();
  const int last = indices_.size() - 1;
  int i = 0;
  if (parity == Parity::kEven && last > 0) {
    (void)windows.try_push_back({indices_[0], indices_[1], 0, false});
    i = 1;
  }
  while (i < last) {
    const int end = std::min(i + 2, last);
    (void)windows.try_push_back({indices_[i], indices_[end], i, end == i + 2});
    i = end;
  }
}

bool Splits::try_merge(int i, int max_window) SOPT_RT {
  if (!is_full_window(i) || !is_full_window(i + 2)) return false;
  if (is_pinned_[i + 1] || is_pinned_[i + 3]) return false;
  // Windows of the other parity end at the neighbours of the merged one.
  const int before = std::max(i - 1, 0);
  const int after = std::min(i + 5, indices_.size() - 1);
  if (indices_[i + 4] - indices_[i] > max_window ||
      indices_[i + 2] - indices_[before] > max_window ||
      indices_[after] - indices_[i + 2] > max_window) {
    return false;
  }
  erase(i + 3);
  erase(i + 1);
  return true;
}

bool Splits::try_merge_as_printed(int i, int max_window) SOPT_RT {
  if (!is_full_window(i) || !is_full_window(i + 2) || is_pinned_[i + 2]) return false;
  // The middle one of three splits is now double; windows of either parity may hold it.
  if (indices_[i + 3] - indices_[i] > max_window ||
      indices_[i + 4] - indices_[i + 1] > max_window) {
    return false;
  }
  erase(i + 2);
  return true;
}

bool Splits::try_rescale(int horizon) SOPT_RT {
  const std::int64_t old_horizon = indices_.empty() ? 0 : indices_.back();
  if (horizon < 1 || old_horizon < 1 || horizon >= indices_.capacity()) return false;
  int size = 0;
  for (int i = 0; i < indices_.size(); ++i) {
    const int index = static_cast<int>((2 * std::int64_t{indices_[i]} * horizon + old_horizon) /
                                       (2 * old_horizon));
    if (size > 0 && indices_[size - 1] == index) {
      is_pinned_[size - 1] = is_pinned_[size - 1] || is_pinned_[i];
      continue;
    }
    is_pinned_[size] = is_pinned_[i];
    indices_[size++] = index;
  }
  (void)indices_.try_resize(size);
  (void)is_pinned_.try_resize(size);
  return true;
}

bool Splits::try_split(int i) SOPT_RT {
  if (!is_full_window(i) || indices_.size() + 2 > indices_.capacity()) return false;
  const int head = indices_[i + 1] - indices_[i];
  const int tail = indices_[i + 2] - indices_[i + 1];
  if (head < 2 || tail < 2) return false;
  return try_insert(i + 2, indices_[i + 1] + tail / 2) && try_insert(i + 1, indices_[i] + head / 2);
}

bool Splits::try_insert(int position, int index) SOPT_RT {
  if (!indices_.try_push_back(index) || !is_pinned_.try_push_back(true)) return false;
  std::rotate(indices_.begin() + position, indices_.end() - 1, indices_.end());
  std::rotate(is_pinned_.begin() + position, is_pinned_.end() - 1, is_pinned_.end());
  return true;
}

void Splits::erase(int position) SOPT_RT {
  std::copy(indices_.begin() + position + 1, indices_.end(), indices_.begin() + position);
  std::copy(is_pinned_.begin() + position + 1, is_pinned_.end(), is_pinned_.begin() + position);
  (void)indices_.try_resize(indices_.size() - 1);
  (void)is_pinned_.try_resize(is_pinned_.size() - 1);
}

}  // namespace sopt
