#include "gradient/bent_path.h"

namespace frictioncg {

namespace {

/// w := w less the normals that are held by now, one by one.
void drop_held(const Iterate& it, Vector& w, Line& line) {
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index N = it.system.first[i], c = N - it.system.interior();
    const Real w_N = w[N];
    if (!it.faces.contact(i) || w_N == 0) continue;
    line.a -= it.rows.r()[c] * w_N;
    line.vAv.A -= w_N * (2 * row_product(it.system, N, w) - it.system.D[N] * w_N);
    line.vAv.D -= it.system.D[N] * w_N * w_N;
    w[N] = 0;
  }
}

}  // namespace

Real follow_bent_path(Iterate& it, Preconditioner& P, LineSearch& search, const Vector& v, Real rho,
                      Line line) {
  const Index contact = it.system.contact_dofs();
  const Vector start_C = it.x.tail(contact);
  Vector w = v;
  Real length = 0;
  line.a -= rho * line.vAv.A;
  for (bool bends = true; bends;) {
    drop_held(it, w, line);
    it.update_friction();
    line.r_v = line.a - it.friction_along(w);
    if (!(line.r_v > 0)) break;
    const Real gap = it.faces.step_to_gap(it.x, w);
    const Real step = search(it.phi, it.g, it.x, w, line, gap);
    if (!std::isfinite(step)) break;  // for the next iteration to name
    it.x.tail(contact) += step * w.tail(contact);
    it.rows.advance(step, w);
    line.a -= step * line.vAv.A;
    length += step;
    bends = step >= gap && it.faces.close_gaps(it.x, w, step);
  }
  if (!(length > 0)) return 0;
  // x_I += length v_I; what the contact dofs have moved otherwise is owed to the interior residual
  const Vector end_C = it.x.tail(contact);
  P.advance(length, v, it.x);
  it.x.tail(contact) = end_C;
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index N = it.system.first[i], c = N - it.system.interior();
    if (it.faces.contact(i)) it.rows.owe(c, end_C[c] - start_C[c] - length * v[N]);
  }
  return length;
}

}  // namespace frictioncg
