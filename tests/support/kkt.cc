#include "tests/support/kkt.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace sopt::oracle {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Index = Eigen::Index;

constexpr double kInf = std::numeric_limits<double>::infinity();

// Keeps NaN, which std::max may lose.
void raise(double& worst, Real value) {
  if (!(value <= static_cast<Real>(worst))) worst = static_cast<double>(value);
}

struct Side {
  Real excess = -kInf;  // bound beyond the value: > 0 violated, < 0 slack
  Real scale = 1;       // max(|a|, |bound|)
};

Side side_of(Real bound, Real value, Real length) {
  if (std::isinf(bound)) return {};
  const Real scale = std::max(length, std::abs(bound));
  return {bound - value, scale > 0 ? scale : Real(1)};
}

struct Values {
  Vector value, length;  // a . x and |a| of all constraints
};

Values values_of(const DenseQp& qp, const Vector& x) {
  const int m = qp.num_rows();
  const Matrix a = qp.a.cast<Real>();
  Values values{Vector(qp.num_constraints()), Vector::Ones(qp.num_constraints())};
  values.value << a * x, x;
  for (int c = 0; c < m; ++c) values.length[c] = a.row(c).norm();
  return values;
}

void append_text(std::string& text, const char* name, const Eigen::MatrixXd& matrix) {
  text += std::string(text.size() > 1 ? "," : "") + "\"" + name + "\":[";
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index j = 0; j < matrix.cols(); ++j) {
      char buffer[40];
      std::snprintf(buffer, sizeof buffer, "%s%.17g", i + j > 0 ? "," : "", matrix(i, j));
      text += buffer;
    }
  }
  text += "]";
}

}  // namespace

DenseQp DenseQp::unconstrained(const Eigen::MatrixXd& h, const Eigen::VectorXd& f) {
  const Index n = f.size();
  return {h,
          f,
          Eigen::MatrixXd(0, n),
          Eigen::VectorXd(0),
          Eigen::VectorXd(0),
          Eigen::VectorXd::Constant(n, -kInf),
          Eigen::VectorXd::Constant(n, kInf)};
}

Eigen::VectorXd DenseQp::normal(int c) const {
  if (c < num_rows()) return a.row(c);
  return Eigen::VectorXd::Unit(num_variables(), c - num_rows());
}

double DenseQp::lower_of(int c) const {
  return c < num_rows() ? lower[c] : lower_x[c - num_rows()];
}

double DenseQp::upper_of(int c) const {
  return c < num_rows() ? upper[c] : upper_x[c - num_rows()];
}

void DenseQp::set_bounds(int c, double low, double high) {
  const bool is_row = c < num_rows();
  const int i = is_row ? c : c - num_rows();
  (is_row ? lower : lower_x)[i] = low;
  (is_row ? upper : upper_x)[i] = high;
}

void DenseQp::add_row(const Eigen::VectorXd& normal, double low, double high) {
  const Index m = a.rows();
  a.conservativeResize(m + 1, f.size());
  a.row(m) = normal.transpose();
  lower.conservativeResize(m + 1);
  upper.conservativeResize(m + 1);
  lower[m] = low;
  upper[m] = high;
}

double ScaledKkt::worst() const {
  double worst = 0.0;
  for (const double value : {stationarity, violation, sign, complementarity}) raise(worst, value);
  return worst;
}

ScaledKkt scaled_kkt(const DenseQp& qp, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& multipliers) {
  const int m = qp.num_rows();
  const int n = qp.num_variables();
  const Matrix h = qp.h.cast<Real>();
  const Matrix a = qp.a.cast<Real>();
  const Vector f = qp.f.cast<Real>();
  const Vector z = x.cast<Real>();
  const Vector l = multipliers.cast<Real>();
  const Vector gap = h * z + f - a.transpose() * l.head(m) - l.tail(n);
  const Vector size = h.cwiseAbs() * z.cwiseAbs() + f.cwiseAbs() +
                      a.cwiseAbs().transpose() * l.head(m).cwiseAbs() + l.tail(n).cwiseAbs();
  const Real dual_scale = n > 0 ? std::max(Real(1), size.maxCoeff()) : Real(1);
  ScaledKkt kkt;
  for (Index j = 0; j < n; ++j) raise(kkt.stationarity, std::abs(gap[j]) / dual_scale);
  const Values values = values_of(qp, z);
  for (int c = 0; c < m + n; ++c) {
    const Real value = values.value[c];
    const Side below = side_of(qp.lower_of(c), value, values.length[c]);
    const Side above = side_of(-static_cast<Real>(qp.upper_of(c)), -value, values.length[c]);
    raise(kkt.violation, below.excess / below.scale);
    raise(kkt.violation, above.excess / above.scale);
    if (std::isnan(value)) raise(kkt.violation, value);
    if (l[c] == 0) continue;
    const Side& side = l[c] > 0 ? below : above;
    const Real share = std::abs(l[c]) * values.length[c] / dual_scale;
    if (std::isinf(side.excess)) {
      raise(kkt.sign, share);
    } else {
      raise(kkt.complementarity, std::min(share, std::abs(side.excess) / side.scale));
    }
  }
  return kkt;
}

double scaled_violation(const DenseQp& qp, const Eigen::VectorXd& x) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(qp.num_constraints());
  return scaled_kkt(qp, x, none).violation;
}

FarkasCertificate farkas_certificate(const OneSided& blocking, const std::vector<OneSided>& others,
                                     int num_free) {
  const Index n = blocking.normal.size();
  const Index q = static_cast<Index>(others.size());
  const Real length =
      std::max(static_cast<Real>(blocking.normal.norm()), std::numeric_limits<Real>::min());
  // Zero rows prove it alone.
  const Real unit = blocking.normal.norm() > 0.0 ? length : Real(1);
  Matrix normals(n, q);
  Vector bounds(q);
  for (Index j = 0; j < q; ++j) {
    const OneSided& other = others[static_cast<std::size_t>(j)];
    const Real other_length = static_cast<Real>(other.normal.norm());
    normals.col(j) = other.normal.cast<Real>() / other_length;
    bounds[j] = static_cast<Real>(other.bound) / other_length;
  }
  const Vector wanted = -blocking.normal.cast<Real>() / unit;
  FarkasCertificate certificate;
  Vector weights = Vector::Zero(q);
  if (q > 0 && n > 0) weights = normals.colPivHouseholderQr().solve(wanted);
  certificate.residual = static_cast<double>((normals * weights - wanted).norm());
  for (Index j = num_free; j < q; ++j) {
    raise(certificate.negativity, -weights[j]);
    weights[j] = std::max(Real(0), weights[j]);
  }
  certificate.gap =
      static_cast<double>(static_cast<Real>(blocking.bound) / unit + weights.dot(bounds));
  return certificate;
}

template <class Scalar>
bool fill(const DenseQp& qp, DenseRows<Scalar>& rows) {
  using Values =
      Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor | Eigen::DontAlign>;
  const Values h = qp.h.cast<Scalar>();
  const Values a = qp.a.cast<Scalar>();
  const Eigen::Matrix<Scalar, Eigen::Dynamic, 1> f = qp.f.cast<Scalar>();
  if (!rows.factorize(qp.num_variables(), h.data())) return false;
  rows.reset(f.data());
  for (int i = 0; i < qp.num_rows(); ++i) {
    if (!rows.try_add(a.data() + i * a.cols(), static_cast<Scalar>(qp.lower[i]),
                      static_cast<Scalar>(qp.upper[i]))) {
      return false;
    }
  }
  for (int j = 0; j < qp.num_variables(); ++j) {
    rows.set_bounds(j, static_cast<Scalar>(qp.lower_x[j]), static_cast<Scalar>(qp.upper_x[j]));
  }
  return true;
}
template bool fill(const DenseQp&, DenseRows<double>&);
template bool fill(const DenseQp&, DenseRows<float>&);

DenseQp rounded_to_float(const DenseQp& qp) {
  const auto rounded = [](const auto& values) {
    return values.template cast<float>().template cast<double>().eval();
  };
  return {rounded(qp.h),     rounded(qp.f),       rounded(qp.a),      rounded(qp.lower),
          rounded(qp.upper), rounded(qp.lower_x), rounded(qp.upper_x)};
}

std::string to_text(const DenseQp& qp) {
  std::string text = "{";
  append_text(text, "H", qp.h);
  append_text(text, "f", qp.f);
  append_text(text, "A", qp.a);
  append_text(text, "lower", qp.lower);
  append_text(text, "upper", qp.upper);
  append_text(text, "lower_x", qp.lower_x);
  append_text(text, "upper_x", qp.upper_x);
  return text + "}";
}

}  // namespace sopt::oracle
