// One axis of a chart: a range that covers the data and ends on ticks, ticks with labels. Linear:
// steps of 1, 2 or 5 times a power of ten. Logarithmic: labels at decades, minor ticks at 2..9,
// ends at 1, 2 or 5 times a decade; up to two and a half decades of data, 2 and 5 have labels too;
// over very many decades only every 2nd, 5th, 10th.. has one. Very large or small values are
// labelled with a power of ten.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace sopt {

struct Tick {
  double value = 0.0;
  std::string label;  // empty: a minor tick
};

class ChartAxis {
 public:
  // At most about `max_ticks` labels. Values that `can_show` refuses are ignored; without any other
  // the range is [0, 1], or [1, 10]. Values that are all integers get no ticks between integers.
  ChartAxis(std::span<const double> values, bool is_log, int max_ticks);

  // Finite and not beyond 1e300; on a logarithmic axis, at least 1e-300.
  [[nodiscard]] static bool can_show(double value, bool is_log);
  // 0 at the lower end, 1 at the upper; `value` is one that `can_show` accepts.
  [[nodiscard]] double position(double value) const;
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] const std::vector<Tick>& ticks() const { return ticks_; }  // increasing

 private:
  void make_linear(double min, double max, bool integers_only, int max_ticks);
  void make_log(double min, double max, int max_ticks);
  void make_many_decades(double min, double max, int max_ticks);

  bool is_log_;
  double lower_ = 0.0, upper_ = 1.0;
  std::vector<Tick> ticks_;
};

}  // namespace sopt
