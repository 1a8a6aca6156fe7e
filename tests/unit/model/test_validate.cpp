#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "../refusal.h"
#include "../scene.h"
#include "core/frictioncg.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

constexpr Real undefined = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinite = std::numeric_limits<Real>::infinity();

struct Legal {
  std::shared_ptr<AssembledSystem> system;
  Increment increment;
};

Legal legal() {
  BlockOptions o;
  o.cells = 2;
  const Scene s = block(o);
  const Posed posed = s.system({0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8});
  return {std::make_shared<AssembledSystem>(assembled(posed.problem().system)),
          posed.problem().increment};
}

std::string refused_system(const std::function<void(AssembledSystem&)>& change) {
  const Legal l = legal();
  change(*l.system);
  return refusal([&] { validate(*l.system); });
}

std::string refused_increment(const std::function<void(Increment&)>& change) {
  Legal l = legal();
  change(l.increment);
  return refusal([&] { validate(l.increment, *l.system); });
}

std::string refused_settings(const std::function<void(Settings&)>& change) {
  Settings s;
  change(s);
  return refusal([&] { validate(s); });
}

/// The refusal says all of it.
void expect(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_TRUE(names(text, part)) << part << " in: " << text;
}

}  // namespace

TEST(Validate, WhatIsLegalPasses) {
  EXPECT_EQ(refused_system([](AssembledSystem&) {}), "");
  EXPECT_EQ(refused_system([](AssembledSystem& s) { s.mesh_node.clear(); }), "");
  EXPECT_EQ(refused_increment([](Increment&) {}), "");
  EXPECT_EQ(refused_increment([](Increment& i) { i.gap[1] = infinite; }), "");
  EXPECT_EQ(refused_increment([](Increment& i) { i.gap[1] = -0.1; }), "");
  EXPECT_EQ(refused_increment([](Increment& i) { i.mu[1] = 0; }), "");
  EXPECT_EQ(refused_increment([](Increment& i) { i.F.setZero(); }), "");
  EXPECT_EQ(refused_settings([](Settings&) {}), "");
}

TEST(Validate, ASystemIsRefusedByItsLayout) {
  expect(refused_system([](AssembledSystem& s) { s.dimension = 4; }), {"dimension = 4", "2 or 3"});
  expect(refused_system([](AssembledSystem& s) { s.dimension = 1; }), {"dimension = 1"});
  expect(refused_system([](AssembledSystem& s) { s.first.clear(); }), {"first"});
  expect(refused_system([](AssembledSystem& s) { s.first[0] = -1; }), {"first"});
  expect(refused_system([](AssembledSystem& s) { s.first[1] = s.first[0]; }),
         {"contact node 0 owns 0 dofs", "at most 1 tangents"});
  expect(refused_system([](AssembledSystem& s) { s.first[0] -= 1; }),
         {"contact node 0 owns 3 dofs"});
  expect(refused_system([](AssembledSystem& s) { s.first.back() -= 1; }),
         {"A is 18 x 18", "ends at 17"});
  expect(refused_system([](AssembledSystem& s) { s.A.uncompress(); }), {"compressed"});
  expect(refused_system([](AssembledSystem& s) { s.D.conservativeResize(17); }),
         {"D has 17", "takes 18"});
  expect(refused_system([](AssembledSystem& s) { s.weight.resize(0); }),
         {"weight has 0", "takes 18"});
  expect(refused_system([](AssembledSystem& s) { s.mesh_node.pop_back(); }), {"mesh_node has 17"});
  expect(refused_system([](AssembledSystem& s) { s.mesh_node[4] = -2; }),
         {"mesh_node = -2 at dof 4"});
}

TEST(Validate, ASystemIsRefusedByItsNumbers) {
  expect(refused_system([](AssembledSystem& s) { s.A.valuePtr()[5] = undefined; }),
         {"A has an entry"});
  expect(refused_system([](AssembledSystem& s) { s.A.valuePtr()[5] = infinite; }),
         {"A has an entry"});
  for (Real bad : {0.0, -1.0, undefined, 1e-90, 1e90}) {
    expect(refused_system([&](AssembledSystem& s) { s.D[3] = bad; }), {"D = ", "at dof 3", "> 0"});
    expect(refused_system([&](AssembledSystem& s) { s.weight[3] = bad; }),
           {"weight = ", "at dof 3"});
  }
}

TEST(Validate, AnIncrementIsRefusedByNameValueNodeAndRule) {
  expect(refused_increment([](Increment& i) { i.mu[1] = -0.3; }),
         {"mu = -0.3 at contact node 1", ">= 0", "give 0"});
  expect(refused_increment([](Increment& i) { i.mu[2] = undefined; }), {"mu = ", "contact node 2"});
  expect(refused_increment([](Increment& i) { i.mu[2] = infinite; }), {"mu = inf"});
  expect(refused_increment([](Increment& i) { i.mu.resize(0); }), {"mu has 0", "takes 3"});
  expect(refused_increment([](Increment& i) { i.F[7] = undefined; }),
         {"F = ", "dof 7", "finite force"});
  expect(refused_increment([](Increment& i) { i.F[7] = -infinite; }), {"F = -inf at dof 7"});
  expect(refused_increment([](Increment& i) { i.F.conservativeResize(3); }), {"F has 3"});
  expect(refused_increment([](Increment& i) { i.gap.resize(0); }), {"gap has 0"});
  expect(refused_increment([](Increment& i) { i.gap[0] = undefined; }),
         {"gap = ", "contact node 0"});
  expect(refused_increment([](Increment& i) { i.gap[0] = -infinite; }), {"gap = -inf"});
  const auto bilateral = [](Increment& i) {
    i.bilateral = true;
    i.gap[0] = infinite;
  };
  expect(refused_increment(bilateral), {"gap = inf at contact node 0", "bilateral"});
  const auto tresca = [](Real g) {
    return [g](Increment& i) {
      i.law = Law::tresca;
      i.g = Vector::Constant(3, 1);
      i.g[1] = g;
    };
  };
  EXPECT_EQ(refused_increment(tresca(0)), "");
  expect(refused_increment(tresca(-2)), {"g = -2 at contact node 1", "sliding limit"});
  expect(refused_increment(tresca(undefined)), {"g = "});
  expect(refused_increment([](Increment& i) { i.law = Law::tresca; }), {"g has 0"});
  EXPECT_EQ(refused_increment([](Increment& i) { i.cohesion = i.cap = Vector::Ones(3); }), "");
  expect(refused_increment([](Increment& i) { i.cohesion = Vector::Ones(2); }),
         {"cohesion has 2", "takes 3"});
  expect(refused_increment([](Increment& i) { i.cap = Vector::Ones(2); }), {"cap has 2"});
  expect(refused_increment([](Increment& i) { i.cohesion = Eigen::Vector3d(0, -1, 0); }),
         {"cohesion = -1", "contact node 1", ">= 0"});
  expect(refused_increment([](Increment& i) { i.cap = Eigen::Vector3d(0, 0, infinite); }),
         {"cap = inf", "contact node 2"});
  for (Real Increment::*norm : {&Increment::load_norm, &Increment::external_norm,
                                &Increment::rounding, &Increment::force_scale})
    for (Real bad : {-1.0, undefined, infinite})
      expect(refused_increment([&](Increment& i) { i.*norm = bad; }), {"load_norm", ">= 0"});
}

TEST(Validate, ALoadWhoseSquaresVanishOrOverflowIsRefused) {
  for (Real size : {1e-160, 1e-90, 1e90, 1e160})
    expect(refused_increment([&](Increment& i) { i.F *= size; }), {"the load is", "other units"});
  for (Real size : {1e-70, 1e-9, 1e70})
    EXPECT_EQ(refused_increment([&](Increment& i) { i.F *= size; }), "");
  const auto penetrates = [](Real gap) {
    return [gap](Increment& i) {
      i.F.setZero();
      i.gap[0] = gap;
    };
  };
  EXPECT_EQ(refused_increment(penetrates(-1e-60)), "");
  expect(refused_increment(penetrates(-1e-160)), {"the load is"});
  EXPECT_EQ(refused_increment([](Increment& i) { i.gap.setConstant(1e-200); }), "");
}

TEST(Validate, SettingsAreRefusedByTheirRange) {
  for (Real tol : {0.0, 1.0, -1e-8, undefined}) {
    expect(refused_settings([&](Settings& s) { s.tol = tol; }), {"tol = ", "between 0 and 1"});
  }
  const auto gc3 = [](Settings& s) { s.method = Method::gc3; };
  for (Real bad : {-1.0, undefined, infinite})
    expect(refused_settings([&](Settings& s) { gc3(s), s.regeps = bad; }), {"regeps = "});
  for (Real bad : {-0.1, 2.0, undefined})
    expect(refused_settings([&](Settings& s) { gc3(s), s.omega = bad; }), {"omega = "});
  expect(refused_settings([](Settings& s) { s.nbiter = -1; }), {"nbiter = -1", ">= 1"});
  for (Real bad : {0.0, -1.0, undefined})
    expect(refused_settings([&](Settings& s) { s.memory = bad; }), {"memory = "});
  for (Real bad : {0.5, undefined, infinite})
    expect(refused_settings([&](Settings& s) { gc3(s), s.partial = bad; }), {"partial = "});
  for (Real bad : {-1.0, 1.0, undefined})
    expect(refused_settings([&](Settings& s) { gc3(s), s.stop_on_step = bad; }), {"stop_on_step"});
}

TEST(Validate, OptionsWithoutEffectAreRefusedAlike) {
  struct Option {
    const char* name;
    void (*set)(Settings&);
    std::string heeded_by;  // c: condensed without Newton, 3: GC1 to GC3, x: GCX, s: SORP, n: auto
  };
  const Option options[] = {
      {"reg", [](Settings& s) { s.reg = Regularization::log_cosh; }, "c3"},
      {"regeps", [](Settings& s) { s.regeps = 1e-3; }, "c3"},
      {"step", [](Settings& s) { s.step = Step::newton; }, "c3"},
      {"precon", [](Settings& s) { s.precon = Precon::diagonal; }, "c3x"},
      {"omega", [](Settings& s) { s.omega = 1.2; }, "c3xs"},
      {"memory", [](Settings& s) { s.memory = 1e9; }, "cn"},
  };
  for (char method : {'c', '1', '2', '3', 'x', 's', 'n', 'N'})
    for (const Option& option : options) {
      Settings s;
      if (method == 'c') s.newton = false;
      if (method == '1') s.method = Method::gc1;
      if (method == '2') s.method = Method::gc2;
      if (method == '3') s.method = Method::gc3;
      if (method == 'x') s.method = Method::gcx;
      if (method == 's') s.method = Method::sorp;
      if (method == 'N') s.method = Method::condensed;
      option.set(s);
      const char kind = method == '1' || method == '2' ? '3' : method == 'N' ? 'n' : method;
      const std::string said = refusal([&] { validate(s); });
      if (option.heeded_by.find(kind) != std::string::npos)
        EXPECT_EQ(said, "") << option.name << " " << method;
      else
        expect(said, {option.name, "no effect", "leave it out"});
    }
  for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp})
    expect(refused_settings([&](Settings& s) { s.method = m, s.newton = false; }), {"newton"});
  for (Precon p : {Precon::none, Precon::diagonal, Precon::hessian_diagonal})
    expect(refused_settings([&](Settings& s) {
             s.method = Method::gc3;
             s.precon = p;
             s.omega = 1.2;
           }),
           {"omega", "SSOR"});
}

TEST(Validate, AStartIsEmptyOrFiniteAndOfTheSystemsSize) {
  const Legal l = legal();
  EXPECT_EQ(refusal([&] { validate_start({}, *l.system); }), "");
  EXPECT_EQ(refusal([&] { validate_start(Vector::Zero(18), *l.system); }), "");
  expect(refusal([&] { validate_start(Vector::Zero(17), *l.system); }), {"x0 has 17", "takes 18"});
  Vector x0 = Vector::Zero(18);
  x0[2] = undefined;
  expect(refusal([&] { validate_start(x0, *l.system); }), {"x0 = ", "at dof 2"});
}

TEST(Validate, TheSolverRefusesWhatItIsGivenBeforeItDoesAnything) {
  Legal l = legal();
  Solver solver(l.system);
  Increment bad = l.increment;
  bad.mu[0] = -1;
  expect(refusal([&] { solver.solve(bad, Settings()); }), {"mu = -1"});
  Settings tight;
  tight.tol = 2;
  expect(refusal([&] { solver.solve(l.increment, tight); }), {"tol = 2"});
  expect(refusal([&] { solver.solve(l.increment, Settings(), Vector::Zero(1)); }), {"x0 has 1"});
  EXPECT_EQ(solver.solve(l.increment, Settings()).status, Status::converged);
  l.system->weight.resize(0);
  expect(refusal([&] { Solver refused(l.system); }), {"weight has 0"});
}
