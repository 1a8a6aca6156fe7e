#include "gradient/bent_path.h"

namespace frictioncg {

BentPath::BentPath(const ContactProblem& problem)
    : system_(*problem.system),
      w_(problem.dofs()),
      start_C_(problem.contact_dofs()),
      end_C_(problem.contact_dofs()) {}

Real BentPath::follow(Iterate& it, Preconditioner& P, LineSearch& search, const Vector& v, Real rho,
                      Line line) {
  const Index contact = system_.contact_dofs();
  Real length = 0;
  w_ = v;
  start_C_ = it.x.tail(contact);
  line.a -= rho * line.vAv.A;
  for (bool bends = true; bends;) {
    drop_held(it, line);
    it.update_friction();
    line.r_v = line.a - it.friction_along(w_);
    if (!(line.r_v > 0)) break;
    const Real gap = it.faces.step_to_gap(it.x, w_);
    const Real step = search(it.phi, it.g, it.x, w_, line, gap);
    if (!std::isfinite(step)) break;  // for the next iteration to name
    it.x.tail(contact) += step * w_.tail(contact);
    it.rows.advance(step, w_);
    line.a -= step * line.vAv.A;
    length += step;
    bends = step >= gap && it.faces.close_gaps(it.x, w_, step);
  }
  if (length > 0) move_interior(it, P, v, length);
  return length;
}

/// w := w less the normals that are held by now, one by one.
void BentPath::drop_held(const Iterate& it, Line& line) {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index N = system_.first[i], c = N - system_.interior();
    const Real w_N = w_[N];
    if (!it.faces.contact(i) || w_N == 0) continue;
    line.a -= it.rows.r()[c] * w_N;
    line.vAv.A -= w_N * (2 * row_product(system_, N, w_) - system_.D[N] * w_N);
    line.vAv.D -= system_.D[N] * w_N * w_N;
    w_[N] = 0;
  }
}

/// x_I += length v_I; what the contact dofs have moved otherwise is owed to the interior residual.
void BentPath::move_interior(Iterate& it, Preconditioner& P, const Vector& v, Real length) {
  const Index contact = system_.contact_dofs(), interior = system_.interior();
  end_C_ = it.x.tail(contact);
  P.advance(length, v, it.x);
  it.x.tail(contact) = end_C_;
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index N = system_.first[i], c = N - interior;
    if (it.faces.contact(i)) it.rows.owe(c, end_C_[c] - start_C_[c] - length * v[N]);
  }
}

}  // namespace frictioncg
