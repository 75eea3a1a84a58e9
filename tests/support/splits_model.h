// The split points W as a plain vector with the rules of opt/splits.h written out again: what a
// merge, a rescaling or a split must do, and when it must be refused. For tests.
#pragma once

#include <cmath>
#include <set>
#include <vector>

#include "opt/splits.h"

namespace sopt::oracle {

struct SplitsModel {
  std::vector<int> w;
  std::set<int> pinned;  // made by a split

  SplitsModel(int horizon, int num_segments) {
    for (int j = 0; j <= 2 * num_segments; ++j) {
      // round(j H / 2N), halves up, in integers
      const long long twice = 2LL * j * horizon;
      const int index = static_cast<int>((twice + 2LL * num_segments) / (4LL * num_segments));
      if (w.empty() || w.back() != index) w.push_back(index);
    }
  }

  [[nodiscard]] int size() const { return static_cast<int>(w.size()); }
  [[nodiscard]] int at(int i) const { return w[static_cast<std::size_t>(i)]; }

  [[nodiscard]] bool can_merge(int i, int max_window) const {
    if (i < 0 || i + 4 >= size()) return false;
    if (pinned.count(at(i + 1)) != 0 || pinned.count(at(i + 3)) != 0) return false;
    const auto fits = [&](int first, int last) { return at(last) - at(first) <= max_window; };
    // The joined window, and those of the other parity on its left, and right.
    return fits(i, i + 4) && (i == 0 || fits(i - 1, i + 2)) &&
           (i + 5 >= size() || fits(i + 2, i + 5));
  }
  void merge(int i) {
    w.erase(w.begin() + i + 3);
    w.erase(w.begin() + i + 1);
  }

  // As printed: the end that both windows share goes, and with it the cuts of the middle split.
  [[nodiscard]] bool can_merge_as_printed(int i, int max_window) const {
    if (i < 0 || i + 4 >= size() || pinned.count(at(i + 2)) != 0) return false;
    return at(i + 3) - at(i) <= max_window && at(i + 4) - at(i + 1) <= max_window;
  }
  void merge_as_printed(int i) { w.erase(w.begin() + i + 2); }

  // Every point in proportion, halves up; a point that several fall on is pinned when one was.
  [[nodiscard]] bool can_rescale(int horizon, int max_horizon) const {
    return horizon >= 1 && horizon <= max_horizon;
  }
  void rescale(int horizon) {
    const long long old_horizon = w.back();
    std::set<int> points;
    std::set<int> new_pinned;
    for (const int point : w) {
      const int moved = static_cast<int>((2LL * point * horizon + old_horizon) / (2 * old_horizon));
      points.insert(moved);
      if (pinned.count(point) != 0) new_pinned.insert(moved);
    }
    w.assign(points.begin(), points.end());
    pinned = new_pinned;
  }

  [[nodiscard]] bool can_split(int i) const {
    return i >= 0 && i + 2 < size() && at(i + 1) - at(i) >= 2 && at(i + 2) - at(i + 1) >= 2;
  }

  // Windows as the header draws them, straight from W.
  [[nodiscard]] std::vector<Window> windows(Parity parity) const {
    std::vector<Window> list;
    int i = 0;
    if (parity == Parity::kEven && size() > 1) {
      list.push_back({at(0), at(1), 0, false});
      i = 1;
    }
    for (; i + 2 < size(); i += 2) list.push_back({at(i), at(i + 2), i, true});
    if (i + 1 < size()) list.push_back({at(i), at(i + 1), i, false});
    return list;
  }
};

[[nodiscard]] inline bool same(const Window& a, const Window& b) {
  return a.first == b.first && a.last == b.last && a.i_split == b.i_split && a.is_full == b.is_full;
}

}  // namespace sopt::oracle
