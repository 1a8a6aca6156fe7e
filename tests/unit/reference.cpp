#include "reference.h"

#include <Eigen/Dense>

namespace frictioncg::test {

Eigen::VectorXd solve_node(const Eigen::MatrixXd& S, const Eigen::VectorXd& f, double gap,
                           double mu, double given, bool coulomb) {
  const int d = int(f.size()), t = d - 1;
  const auto limit = [&](double r_N) { return coulomb ? mu * std::max(r_N, 0.0) : given; };
  Eigen::VectorXd best = Eigen::VectorXd::Zero(d);
  for (bool closed : {false, true}) {
    // unknowns: x_N if open, x_T = T(lambda) with S_TT + lambda I, lambda = g/|x_T| (infinite:
    // stick)
    const auto at = [&](double lambda) {
      Eigen::MatrixXd K = S;
      Eigen::VectorXd b = f;
      for (int k = 1; k < d; ++k) K(k, k) += lambda;
      if (closed) {
        K.row(0).setZero();
        K(0, 0) = 1;
        b[0] = gap;
      }
      return Eigen::VectorXd(K.lu().solve(b));
    };
    const auto excess = [&](double lambda) {  // g - lambda |x_T|, increasing in lambda at its root
      const Eigen::VectorXd x = at(lambda);
      const double r_N = closed ? f[0] - S.row(0).dot(x) : 0;
      return limit(r_N) - lambda * x.tail(t).norm();
    };
    Eigen::VectorXd x;
    if (t == 0) {
      x = at(0);
    } else {
      // stick first
      x = Eigen::VectorXd::Zero(d);
      x[0] = closed ? gap : f[0] / S(0, 0);
      const Eigen::VectorXd r = f - S * x;
      if (r.tail(t).norm() > limit(closed ? r[0] : 0)) {
        const double scale = S.diagonal().maxCoeff();
        double low = 0, high = scale;
        if (limit(closed ? f[0] - S.row(0).dot(at(0)) : 0) > 0) {
          while (excess(high) > 0 && high < 1e14 * scale) high *= 2;
          for (int k = 0; k < 200; ++k) {
            const double middle = 0.5 * (low + high);
            (excess(middle) > 0 ? low : high) = middle;
          }
        } else {
          high = 0;
        }
        x = at(high);
      }
    }
    const double r_N = f[0] - S.row(0).dot(x);
    best = x;
    if (!closed && x[0] <= gap) return x;
    if (closed && r_N >= 0) return x;
  }
  return best;
}

Reference reference_solution(const ContactProblem& p) {
  const Eigen::MatrixXd A = p.system->entries();
  const int interior = p.interior(), n = p.dofs(), contact = n - interior;
  const Eigen::LDLT<Eigen::MatrixXd> A_II(A.topLeftCorner(interior, interior));
  const Eigen::MatrixXd A_IC = A.topRightCorner(interior, contact);
  const Eigen::MatrixXd S =
      A.bottomRightCorner(contact, contact) - A_IC.transpose() * A_II.solve(A_IC);
  const Eigen::VectorXd f =
      p.increment.F.tail(contact) - A_IC.transpose() * A_II.solve(p.increment.F.head(interior));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(contact);
  Reference result;
  for (int sweep = 0; sweep < 4000 && !result.converged; ++sweep) {
    double change = 0;
    for (int i = 0; i < p.nodes(); ++i) {
      const int N = p.system->first[i] - interior,
                size = p.system->first[i + 1] - p.system->first[i];
      const Eigen::MatrixXd S_ii = S.block(N, N, size, size);
      const Eigen::VectorXd f_i =
          f.segment(N, size) - S.middleRows(N, size) * x + S_ii * x.segment(N, size);
      const Eigen::VectorXd x_i = solve_node(
          S_ii, f_i, p.increment.gap[i], p.increment.law == Law::coulomb ? p.increment.mu[i] : 0,
          p.increment.law == Law::tresca ? p.increment.g[i] : 0, p.increment.law == Law::coulomb);
      change = std::max(change, (x_i - x.segment(N, size)).norm());
      x.segment(N, size) = x_i;
    }
    result.converged = change <= 1e-14 * x.norm();
  }
  result.x.resize(n);
  result.x.tail(contact) = x;
  result.x.head(interior) = A_II.solve(p.increment.F.head(interior) - A_IC * x);
  return result;
}

namespace {

/// The solution of K x = b; the least of all where K is singular.
Eigen::VectorXd solve_or_least_squares(const Eigen::MatrixXd& K, const Eigen::VectorXd& b) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(K);
  if (lu.rcond() > 1e-9) return lu.solve(b);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
  cod.setThreshold(1e-12);
  return cod.compute(K).solve(b);
}

}  // namespace

bool any_combination_of_branches(const Eigen::MatrixXd& S, const Eigen::VectorXd& f,
                                 const Eigen::VectorXd& gap, const Eigen::VectorXd& mu) {
  const int m = int(gap.size());
  const double force = f.cwiseAbs().maxCoeff(), stiffness = S.diagonal().cwiseAbs().maxCoeff();
  for (int code = 0; code < 1 << (2 * m); ++code) {
    Eigen::MatrixXd K = S / stiffness;
    Eigen::VectorXd b = f / stiffness;
    for (int i = 0; i < m; ++i) {
      const int branch = code >> (2 * i) & 3, N = 2 * i,
                T = 2 * i + 1;  // 0 open, 1 stick, 2, 3 slip
      if (branch >= 2) {        // r_T = +- mu r_N, r = f - Sx
        const double factor = (branch == 2 ? 1 : -1) * mu[i];
        K.row(T) -= factor * K.row(N);
        b[T] -= factor * b[N];
      }
      if (branch >= 1) {
        K.row(N) = Eigen::RowVectorXd::Unit(2 * m, N);
        b[N] = gap[i];
      }
      if (branch == 1) {
        K.row(T) = Eigen::RowVectorXd::Unit(2 * m, T);
        b[T] = 0;
      }
    }
    const Eigen::VectorXd x = solve_or_least_squares(K, b);
    const Eigen::VectorXd r = f - S * x;
    const double length = std::max(x.cwiseAbs().maxCoeff(), force / stiffness);
    bool good = (K * x - b).norm() < 1e-9 * (b.norm() + length);
    for (int i = 0; i < m && good; ++i) {
      const int branch = code >> (2 * i) & 3;
      const double r_N = r[2 * i], r_T = r[2 * i + 1], x_T = x[2 * i + 1];
      if (branch == 0) good = x[2 * i] <= gap[i] + 1e-9 * length;
      if (branch >= 1) good = r_N >= -1e-9 * force;
      if (branch == 1) good &= std::abs(r_T) <= mu[i] * r_N + 1e-9 * force;
      if (branch == 2) good &= x_T >= -1e-9 * length;
      if (branch == 3) good &= x_T <= 1e-9 * length;
    }
    if (good) return true;
  }
  return false;
}

}  // namespace frictioncg::test
