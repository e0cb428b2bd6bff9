#include "smoothing/integrators/chebyshev.h"

#include <cmath>
#include <complex>

namespace rfsmooth::smoothing {

using Complex = std::complex<double>;
using Eigen::Vector4f;

std::optional<std::vector<double>> inverse_polynomial(double a1, double a2, double reduction, int most) {
  if (a1 * a1 > 3.9 * a2) return std::nullopt;  // from 4 a2 on the roots are real
  const Complex first = Complex(-a1, std::sqrt(4 * a2 - a1 * a1)) / (2 * a2) - 1.0, second = std::conj(first);
  // T_(m-1) and T_m at the two roots.
  Complex below1 = 1, here1 = first, below2 = 1, here2 = second;
  double a = 0, b = 0;
  int m = 1;
  do {
    if (++m > most + 2) return std::nullopt;
    const Complex next1 = 2.0 * first * here1 - below1, next2 = 2.0 * second * here2 - below2;
    below1 = here1;
    here1 = next1;
    below2 = here2;
    here2 = next2;
    const Complex determinant = here1 * below2 - here2 * below1;
    a = ((below2 - below1) / determinant).real();
    b = ((here1 - here2) / determinant).real();
    if (!std::isfinite(a) || !std::isfinite(b)) return std::nullopt;
  } while (std::abs(a) + std::abs(b) > reduction);

  // p has degree m - 2: its values at m - 1 Chebyshev nodes determine it.
  const int nodes = m - 1;
  std::vector<double> value(std::size_t(nodes), 0), coefficients(value.size(), 0);
  const auto angle = [&](int j) { return M_PI * (j + 0.5) / nodes; };
  for (int j = 0; j < nodes; ++j) {
    const double k = 1 + std::cos(angle(j));
    const double q = a * std::cos(m * angle(j)) + b * std::cos((m - 1) * angle(j));
    value[std::size_t(j)] = (1 - q) / (1 + a1 * k + a2 * k * k);
  }
  for (int c = 0; c < nodes; ++c) {
    for (int j = 0; j < nodes; ++j)
      coefficients[std::size_t(c)] += value[std::size_t(j)] * std::cos(c * angle(j));
    coefficients[std::size_t(c)] *= (c == 0 ? 1.0 : 2.0) / nodes;
  }
  return coefficients;
}

void apply_polynomial(const std::vector<double>& coefficients, const Adjacency& rows, Vectors<Vector4f>& v,
                      Vectors<Vector4f>& d, const Context& context) {
  const std::size_t n = v.size();
  // t(L) x = L x - x: minus the mean of the neighbours.
  const auto shifted = [&](const Vectors<Vector4f>& x, std::size_t i) {
    const Index begin = rows.start[i], end = rows.start[i + 1];
    if (begin == end) return Vector4f(-x[i]);
    Vector4f sum = Vector4f::Zero();
    for (Index k = begin; k < end; ++k) sum += x[rows.items[k]];
    return Vector4f((-1 / float(end - begin)) * sum);
  };
  const auto coefficient = [&](std::size_t k) {
    return k < coefficients.size() ? float(coefficients[k]) : 0.0F;
  };
  Vectors<Vector4f> before(n);  // T_(k-1) v, and v is T_k v
  before.swap(v);
  for_each_index(context, n, [&](std::size_t i) {
    v[i] = shifted(before, i);
    d[i] = coefficient(0) * before[i] + coefficient(1) * v[i];
  });
  for (std::size_t k = 2; k < coefficients.size(); ++k) {
    const float c = coefficient(k);
    for_each_index(context, n, [&](std::size_t i) {
      const Vector4f next = 2 * shifted(v, i) - before[i];
      before[i] = next;
      d[i] += c * next;
    });
    before.swap(v);
  }
}

}  // namespace rfsmooth::smoothing
