// Split points under random merges of both kinds, splits and rescalings against a second
// implementation of the rules on a plain vector: the same acceptance, the same W, cover without
// overlap in both parities, windows downstream of a paired merge unchanged, the cap kept, points
// made by a split there for good, refusals without effect.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/property.h"
#include "tests/support/splits_model.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr int kMaxHorizon = 600;
constexpr Parity kParities[] = {Parity::kOdd, Parity::kEven};

struct Fixture {
  InArena<Splits> splits{kMaxHorizon};
  InArena<FixedVector<Window>> windows{kMaxHorizon + 1};
};

std::vector<Window> list(Fixture& f, Parity parity) {
  f.splits->list_windows(parity, *f.windows);
  return {f.windows->begin(), f.windows->end()};
}

int longest_window(Fixture& f) {
  int longest = 0;
  for (const Parity parity : kParities) {
    for (const Window& window : list(f, parity)) longest = std::max(longest, window.num_steps());
  }
  return longest;
}

void check_windows(Fixture& f, const SplitsModel& model, CaseReport& report) {
  const auto indices = f.splits->indices();
  report.expect("W is as the rules say",
                std::equal(indices.begin(), indices.end(), model.w.begin(), model.w.end()));
  for (const Parity parity : kParities) {
    const std::vector<Window> listed = list(f, parity);
    const std::vector<Window> expected = model.windows(parity);
    report.expect("windows follow from W",
                  std::equal(listed.begin(), listed.end(), expected.begin(), expected.end(), same));
    int covered = 0;
    for (const Window& window : listed) {
      report.expect("windows cover without overlap", window.first == covered);
      report.expect("a window has a step", window.num_steps() >= 1);
      covered = window.last;
    }
    report.expect("windows reach the end", covered == model.w.back());
  }
}

// Windows that begin at or behind `index`.
std::vector<Window> downstream(Fixture& f, Parity parity, int index) {
  std::vector<Window> rest;
  for (Window window : list(f, parity)) {
    window.i_split = 0;
    if (window.first >= index) rest.push_back(window);
  }
  return rest;
}

void check_merge(Fixture& f, int i, int max_window, SplitsModel& model, CaseReport& report) {
  const bool expected = model.can_merge(i, max_window);
  const int end = expected ? model.at(i + 4) : 0;
  std::vector<Window> before[2];
  for (const Parity parity : kParities) {
    before[static_cast<int>(parity)] = downstream(f, parity, end);
  }
  const bool merged = f.splits->try_merge(i, max_window);
  report.expect("merges exactly what may be merged", merged == expected);
  if (!merged) return;
  model.merge(i);
  for (const Parity parity : kParities) {
    const std::vector<Window> after = downstream(f, parity, end);
    const std::vector<Window>& was = before[static_cast<int>(parity)];
    report.expect("a merge keeps the parity downstream",
                  std::equal(after.begin(), after.end(), was.begin(), was.end(), same));
  }
}

void check_printed_merge(Fixture& f, int i, int max_window, SplitsModel& model,
                         CaseReport& report) {
  const bool expected = model.can_merge_as_printed(i, max_window);
  report.expect("merges as printed exactly what may be merged",
                f.splits->try_merge_as_printed(i, max_window) == expected);
  if (expected) model.merge_as_printed(i);
}

// Returns the cap: a longer horizon stretches windows, points that fall together join splits.
int check_rescale(Fixture& f, int horizon, int max_window, SplitsModel& model, CaseReport& report) {
  const bool expected = model.can_rescale(horizon, kMaxHorizon);
  report.expect("rescales to what fits", f.splits->try_rescale(horizon) == expected);
  if (!expected) return max_window;
  model.rescale(horizon);
  return std::max(max_window, longest_window(f));
}

void check_split(Fixture& f, int i, SplitsModel& model, CaseReport& report) {
  const bool is_possible = model.can_split(i);
  if (!f.splits->try_split(i)) {
    // W may be full.
    report.expect("splits what may be split", !is_possible || model.size() + 2 > 2 * kMaxSegments);
    return;
  }
  report.expect("splits only what may be split", is_possible);
  if (!is_possible) return;
  const auto indices = f.splits->indices();
  if (static_cast<int>(indices.size()) != model.size() + 2) {
    report.fail("a split adds two points");
    return;
  }
  const int first_half = indices[static_cast<std::size_t>(i) + 1];
  const int second_half = indices[static_cast<std::size_t>(i) + 3];
  // Halves differ by at most one step.
  report.expect("halves the first split",
                std::abs(model.at(i) + model.at(i + 1) - 2 * first_half) <= 1);
  report.expect("halves the second split",
                std::abs(model.at(i + 1) + model.at(i + 2) - 2 * second_half) <= 1);
  model.w.insert(model.w.begin() + i + 2, second_half);
  model.w.insert(model.w.begin() + i + 1, first_half);
  model.pinned.insert(first_half);
  model.pinned.insert(second_half);
}

std::string check_case(Random& random, CaseReport& report) {
  static Fixture f;
  const int horizon = 1 + random.index(random.chance(0.3) ? 12 : kMaxHorizon);
  const int num_segments = 1 + random.index(random.chance(0.2) ? horizon : 1 + horizon / 8);
  std::string input = "H " + std::to_string(horizon) + " N " + std::to_string(num_segments);
  SplitsModel model(horizon, num_segments);
  if (!f.splits->try_reset(horizon, num_segments)) {
    report.expect("fits", model.size() > 2 * kMaxSegments);
    return input;
  }
  check_windows(f, model, report);
  // As in use: every window is within the cap before the first merge.
  int max_window = longest_window(f) + random.index(80);
  input += " cap " + std::to_string(max_window) + ":";
  for (int k = random.index(60); k > 0 && !report.failed(); --k) {
    const int i = random.index(model.size() + 2) - 1;
    const double kind = random.uniform(0.0, 1.0);
    if (kind < 0.4) {
      input += " m" + std::to_string(i);
      check_merge(f, i, max_window, model, report);
    } else if (kind < 0.7) {
      input += " p" + std::to_string(i);
      check_printed_merge(f, i, max_window, model, report);
    } else if (kind < 0.9) {
      input += " s" + std::to_string(i);
      check_split(f, i, model, report);
    } else {
      const int now = model.w.back();
      const int to = random.chance(0.8) ? now + random.index(21) - 15 : random.index(700);
      input += " r" + std::to_string(to);
      max_window = check_rescale(f, to, max_window, model, report);
    }
    check_windows(f, model, report);
    report.expect("the cap holds for both parities", longest_window(f) <= max_window);
    for (const int point : model.pinned) {
      report.expect("a point made by a split stays",
                    std::binary_search(model.w.begin(), model.w.end(), point));
    }
    report.expect("counts its segments", f.splits->num_segments() == model.size() / 2);
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) { return run_property("splits", argc, argv, check_case); }
