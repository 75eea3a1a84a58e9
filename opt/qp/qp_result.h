// What a QP solve is asked for and what it answers. All row quantities are in the row's own scaled
// unit: the row spaces give their rows unit length (metres or radians in a segment QP).
#pragma once

#include <cstdint>
#include <span>

namespace sopt {

enum class QpStatus : std::int8_t {
  kOptimal = 0,
  kNotSolved = -1,   // default
  kInfeasible = -2,  // blocking_row cannot hold together with the others
  kStepLimit = -3,   // max_steps working-set changes were not enough
  kDeadline = -4,
  kCapacity = -5,    // more active rows than the workspace holds
  kInaccurate = -6,  // rounding: rows hold to primal_residual only, or steps made no progress
  kBadInput = -7,    // data is not finite, or the Hessian not positive definite
};

template <class Scalar>
struct QpTolerance;
template <>
struct QpTolerance<double> {
  // Rows may be violated by this much.
  static constexpr double kViolation = 1e-12;
  // Dependent rows this far apart, per size of their terms, contradict each other.
  static constexpr double kConflict = 1e-9;
  // Active rows this far off, likewise: the factor is no good.
  static constexpr double kAstray = 1e-7;
  // Relative curvature below which directions are refined, and that of a dependent row after that.
  static constexpr double kSuspect = 1e-4;
  static constexpr double kSingular = 1e-20;
  // What a refined direction may miss, and entries of a direction that do not block; relative.
  static constexpr double kSettled = 1e-8;
  static constexpr double kBlocking = 1e-9;
  // Multipliers below 0 by this much, relative, are 0.
  static constexpr double kNegative = 2e-14;
};
template <>
struct QpTolerance<float> {
  static constexpr float kViolation = 2e-6F;
  static constexpr float kConflict = 1e-4F;
  static constexpr float kAstray = 1e-3F;
  static constexpr float kSuspect = 3e-2F;
  static constexpr float kSingular = 1e-10F;
  static constexpr float kSettled = 1e-3F;
  static constexpr float kBlocking = 1e-5F;
  static constexpr float kNegative = 5e-7F;
};

// Rows that were active in the solution of a similar problem. A hint: ids that do not exist,
// repeat, depend on others or have a multiplier that is not positive are passed over.
template <class Scalar>
struct QpWarmStart {
  std::span<const int> rows{};
  std::span<const Scalar> multipliers{};  // one per row, or none
};

template <class Scalar>
struct QpOptions {
  Scalar violation_tolerance = QpTolerance<Scalar>::kViolation;
  int max_steps = 1000;  // working-set changes
  QpWarmStart<Scalar> warm{};
};

template <class Scalar>
struct QpResult {
  QpStatus status = QpStatus::kNotSolved;
  int num_steps = 0;  // working-set changes, those of the warm start included
  int num_active = 0;
  int num_refactored = 0;  // rebuilds of the factor after rounding got in the way
  int blocking_row = -1;   // id, when infeasible
  // |violation| of active rows and violation of those that could not be made active, largest; when
  // not kOptimal, of all others too, which else hold within the tolerance.
  Scalar primal_residual = 0;
  Scalar dual_residual = 0;  // most negative multiplier, relative to the largest
  Scalar gap = 0;            // sum |multiplier x residual| of active rows, in the cost's unit
};

}  // namespace sopt
