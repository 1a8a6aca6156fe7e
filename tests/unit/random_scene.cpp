#include "random_scene.h"

namespace frictioncg::test {

Recipe random_recipe(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return std::uniform_real_distribution<Real>(0, 1)(random); };
  const auto chance = [&](Real p) { return uniform() < p; };
  Recipe r;
  r.seed = seed;
  r.algebraic = chance(0.4);
  BlockOptions& b = r.block;
  b.seed = seed;
  b.d = chance(0.6) ? 2 : 3;
  b.cells = 1 + int((b.d == 2 ? 10 : 3) * uniform());
  r.nodes = 1 + int(60 * std::pow(uniform(), 2));
  r.rank_deficit = chance(0.3) ? 1 + int(b.d * uniform()) : 0;
  r.contrast = chance(0.3) ? std::pow(10, 4 * uniform()) : 1;
  b.clamp_side = chance(0.6);
  b.angle = b.clamp_side || chance(0.3) ? 0 : 6 * uniform();
  b.distortion = chance(0.5) ? 0.25 * uniform() : 0;
  b.nu = chance(0.2) ? 0.4999 : 0.45 * uniform();
  b.pressure = chance(0.1) ? -uniform() : 10 * uniform();
  b.law = chance(0.1) ? Law::frictionless : chance(0.15) ? Law::tresca : Law::coulomb;
  b.mu = chance(0.1) ? 10 * uniform() : uniform();
  const Real limit = std::min(b.mu, 1.0) * b.pressure;
  b.shear = chance(0.1)   ? limit  // exactly at the limit of friction
            : chance(0.1) ? 0
                          : limit * (1.8 * uniform() - 0.9) * (b.clamp_side ? 3 : 1);
  r.gaps = chance(0.4) && (b.clamp_side || r.algebraic);
  r.equal_gaps = chance(0.3);
  r.mu_varies = chance(0.5);
  r.mu_vanishes = chance(0.2);
  r.no_load = chance(0.03);
  r.orthotropic = b.d == 3 && chance(0.2) && !b.clamp_side;
  return r;
}

Recipe with_bounds(Recipe r) {
  std::mt19937 random(r.seed + 1000003u);  // another sequence: the recorded seeds keep their scenes
  const auto uniform = [&] { return std::uniform_real_distribution<Real>(0, 1)(random); };
  if (r.block.law != Law::coulomb) return r;
  const Real kind = uniform();
  if (kind < 0.7) r.cohesion = uniform();
  if (kind > 0.4) r.cap = r.cohesion + uniform() * uniform();
  r.bounds_vary = uniform() < 0.5;
  if (uniform() < 0.1) r.block.mu = 0;
  return r;
}

Scene algebraic_scene(const Recipe& r, std::mt19937& random) {
  const BlockOptions& o = r.block;
  std::normal_distribution<Real> normal;
  std::uniform_real_distribution<Real> uniform(0, 1);
  Scene s;
  s.d = o.d;
  s.n = o.d * r.nodes;
  s.law = o.law;
  const Index rank = std::max(1, s.n - r.rank_deficit);
  Eigen::MatrixXd B(s.n, rank);
  for (Index i = 0; i < B.size(); ++i) B.data()[i] = normal(random);
  for (Index p = 0; p < r.nodes; ++p)
    B.middleRows(o.d * p, o.d) *= std::pow(r.contrast, 0.5 * uniform(random));
  Eigen::MatrixXd A = B * B.transpose() * (o.E / s.n);
  // mostly weak coupling from node to node, as elasticity has it
  for (Index p = 0; p < r.nodes; ++p)
    if (r.rank_deficit == 0)
      A.block(o.d * p, o.d * p, o.d, o.d) +=
          (o.E * uniform(random)) * Eigen::MatrixXd::Identity(o.d, o.d);
  s.b.resize(s.n);
  for (Index p = 0; p < r.nodes; ++p) {
    Eigen::Vector3d n(0, 0, 0), f(0, 0, 0);
    for (int c = 0; c < o.d; ++c) n[c] = normal(random);
    if (o.angle == 0) n = -Eigen::Vector3d::Unit(o.d - 1);
    n.normalize();
    for (int c = 0; c < o.d; ++c) f[c] = o.shear * normal(random);
    f += n * (o.pressure - n.dot(f));
    s.b.segment(o.d * p, o.d) = f.head(o.d);
    ContactPoint point;
    for (int c = 0; c < o.d; ++c) {
      point.dof[c] = o.d * p + c;
      point.normal[c] = n[c];
    }
    point.friction = o.law != Law::frictionless;
    s.points.push_back(point);
  }
  for (Index p = 0; p < s.n; ++p)
    for (Index q = 0; q < s.n; ++q) {
      s.i.push_back(p);
      s.j.push_back(q);
      s.a.push_back(0.5 * (A(p, q) + A(q, p)));
    }
  s.gap = Vector::Zero(r.nodes);
  s.friction = Vector::Constant(r.nodes, o.mu);
  return s;
}

Scene make_scene(const Recipe& r) {
  std::mt19937 random(r.seed);
  std::uniform_real_distribution<Real> uniform(0, 1);
  Scene s = r.algebraic ? algebraic_scene(r, random) : block(r.block);
  const Real length = 0.2 * r.block.pressure / r.block.E;
  for (Index k = 0; k < s.gap.size(); ++k) {
    if (r.mu_varies) s.friction[k] *= 0.5 + 0.5 * uniform(random);
    if (r.mu_vanishes && uniform(random) < 0.3) s.friction[k] = 0;
    if (r.gaps)
      s.gap[k] = r.equal_gaps ? length * (uniform(random) < 0.5) : length * (uniform(random) - 0.3);
    if (r.orthotropic && s.law == Law::coulomb) {
      s.points[k].mu_ratio = 0.3;
      s.points[k].direction = {std::cos(Real(r.seed)), 0.1, std::sin(Real(r.seed))};
    }
  }
  if (r.no_load) s.b.setZero();
  const Index m = static_cast<Index>(s.points.size());
  const Real unit = std::abs(r.block.pressure) *
                    (r.algebraic ? 1 : std::pow(r.block.size / r.block.cells, r.block.d - 1));
  for (const auto& [values, size] : {std::pair{&s.cohesion, r.cohesion}, {&s.cap, r.cap}}) {
    if (size == 0) continue;
    *values = Vector::Constant(m, size * unit);
    for (Index k = 0; k < m && r.bounds_vary; ++k) (*values)[k] *= 2 * uniform(random);
  }
  if (s.cohesion.size() > 0)
    for (ContactPoint& p : s.points) p.friction = true;
  return s;
}

Recipe shrink(Recipe r, const std::function<bool(const Recipe&)>& fails) {
  using Change = std::function<void(Recipe&)>;
  const std::vector<Change> changes{
      [](Recipe& q) { q.nodes /= 2; },
      [](Recipe& q) { q.nodes -= 1; },
      [](Recipe& q) { q.block.cells /= 2; },
      [](Recipe& q) { q.block.cells -= 1; },
      [](Recipe& q) { q.block.d = 2, q.orthotropic = false; },
      [](Recipe& q) { q.orthotropic = false; },
      [](Recipe& q) { q.cohesion = 0; },
      [](Recipe& q) { q.cap = 0; },
      [](Recipe& q) { q.bounds_vary = false; },
      [](Recipe& q) { q.gaps = false; },
      [](Recipe& q) { q.mu_varies = false; },
      [](Recipe& q) { q.mu_vanishes = false; },
      [](Recipe& q) { q.rank_deficit = 0; },
      [](Recipe& q) { q.contrast = 1; },
      [](Recipe& q) { q.block.angle = 0; },
      [](Recipe& q) { q.block.distortion = 0; },
      [](Recipe& q) { q.block.nu = 0.3; },
      [](Recipe& q) { q.block.law = Law::frictionless, q.cohesion = q.cap = 0; },
      [](Recipe& q) { q.block.shear = 0; },
  };
  const auto describe = [](const Recipe& q) {
    std::ostringstream s;
    s << q;
    return s.str();
  };
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (const Change& change : changes) {
      Recipe q = r;
      change(q);
      if (q.nodes < 1 || q.block.cells < 1 || describe(q) == describe(r) || !fails(q)) continue;
      r = q;
      smaller = true;
    }
  }
  return r;
}

void write(const Scene& s, const std::string& file) {
  std::ofstream out(file);
  out.precision(17);
  out << s.n << " " << s.d << " " << s.points.size() << " " << int(s.law) << "\n"
      << s.a.size() << "\n";
  for (std::size_t k = 0; k < s.a.size(); ++k)
    out << s.i[k] << " " << s.j[k] << " " << s.a[k] << "\n";
  out << s.b << "\n";
  for (std::size_t k = 0; k < s.points.size(); ++k) {
    const ContactPoint& p = s.points[k];
    for (Index dof : p.dof) out << dof << " ";
    for (Real c : p.normal) out << c << " ";
    out << s.gap[k] << " " << s.friction[k] << " ";
    for (Real c : p.direction) out << c << " ";
    out << p.mu_ratio << "\n";
  }
}

}  // namespace frictioncg::test
