#pragma once
#include "../core/settings.h"

namespace frictioncg {

constexpr const char* version = "1.0";  ///< a script asks for frictionCGversion
constexpr const char* operator_name = "frictionalContactCG";
constexpr const char* constructor_name = "contactProblem";

/// The named parameters of the operator and of the constructor, with FreeFEM's types.
#define FRICTIONCG_PARAMETERS(X)                                                        \
  X(mu, double)               /* friction coefficient */                                \
  X(mu2, double)              /* across direction, mu being along it */                 \
  X(direction, E_Array)       /* of orthotropic friction */                             \
  X(gap, double)              /* [length] */                                            \
  X(normal, E_Array)          /* outward from the body */                               \
  X(cohesion, double)         /* [force/area] */                                        \
  X(shearmax, double)         /* [force/area] */                                        \
  X(slidinglimit, double)     /* [force/area] */                                        \
  X(bilateral, bool)          /* no separation */                                       \
  X(maxgap, double)           /* of two bodies [length] */                              \
  X(smooth, bool)             /* of two bodies: gap of the curved surfaces */           \
  X(weight, double)           /* of the forms: x, where they are axisymmetric */        \
  X(pivot, E_Array)           /* of an obstacle that moves */                           \
  X(obstacles, KN_<long>)     /* labels of those that move */                           \
  X(motionfree, KN_<long>)    /* 1: under a load; 0: given */                           \
  X(motion, KN<double>*)      /* in and out [length, radians] */                        \
  X(motionload, KN_<double>)  /* [force, moment] */                                     \
  X(motionold, KN_<double>)   /* of uold */                                             \
  X(motionforce, KN<double>*) /* out, of an obstacle on the body */                     \
  X(uold, KN_<double>)        /* [length] */                                            \
  X(at, KN_<double>)          /* of the geometry [length] */                            \
  X(forceold, KN_<double>)    /* at `at`, an output force [force] */                    \
  X(init, KN_<double>)        /* [length] */                                            \
  X(start, KN_<double>)       /* the same, where macro_ddm.idp takes the name init */   \
  X(method, string*)                                                                    \
  X(newton, bool) /* condensed: on the laws themselves */                               \
  X(reg, string*)                                                                       \
  X(regeps, double) /* [length] */                                                      \
  X(precon, string*)                                                                    \
  X(omega, double)                                                                      \
  X(step, string*)                                                                      \
  X(tol, double)                                                                        \
  X(nbiter, double) /* a whole number */                                                \
  X(memory, double) /* [GB] */                                                          \
  X(threads, long)  /* of multigrid */                                                  \
  X(verb, long)                                                                         \
  X(status, long*)              /* out */                                               \
  X(residual, double*)          /* out */                                               \
  X(iterations, long*)          /* out */                                               \
  X(force, KN<double>*)         /* out [force] */                                       \
  X(state, KN<long>*)           /* out */                                               \
  X(normals, KN<double>*)       /* out */                                               \
  X(distance, KN<double>*)      /* out, of two bodies [length] */                       \
  X(free, long*)                /* out */                                               \
  X(history, KNM<double>*)      /* out */                                               \
  X(times, KN<double>*)         /* out [s] */                                           \
  X(domain, void)               /* of several processes: frictionCG-mpi has its type */ \
  X(obstacle, KN_<long>)        /* beside pairs: its labels, in any form */             \
  X(obstaclegap, double)        /* [length] */                                          \
  X(obstaclenormal, E_Array)    /* outward from the body */                             \
  X(obstacleforce, KN<double>*) /* out [force] */

enum Parameter {
#define FRICTIONCG_NUMBER(name, type) p_##name,
  FRICTIONCG_PARAMETERS(FRICTIONCG_NUMBER)
#undef FRICTIONCG_NUMBER
      parameter_count
};

const char* name_of(Parameter p);

/// The parameters that give a contact problem its tangential laws.
constexpr std::initializer_list<Parameter> frictions = {p_mu, p_cohesion, p_slidinglimit};
/// The tractions that bound friction, which contact integrates.
constexpr std::initializer_list<Parameter> tractions = {p_cohesion, p_shearmax, p_slidinglimit};
/// What an obstacle beside pairs of bodies has.
constexpr std::initializer_list<Parameter> of_obstacle_beside_pairs = {
    p_obstacle, p_obstaclegap, p_obstaclenormal, p_obstacleforce};
/// What a new matrix of a contactproblem may bring along.
constexpr std::initializer_list<Parameter> of_geometry = {
    p_normal, p_obstaclenormal, p_maxgap, p_smooth, p_weight, p_at, p_forceold};
/// What lets an obstacle move.
constexpr std::initializer_list<Parameter> of_moving_obstacle = {
    p_pivot, p_obstacles, p_motionfree, p_motion, p_motionload, p_motionold, p_motionforce};

/// A table of the values that a string parameter may take.
template <class T>
struct Choice {
  const char* name;
  T value;
};
constexpr Choice<Method> methods[] = {
    {"auto", Method::automatic}, {"condensed", Method::condensed},
    {"GC3", Method::gc3},        {"GC2", Method::gc2},
    {"GC1", Method::gc1},        {"GCX", Method::gcx},
    {"SORP", Method::sorp},      {"multigrid", Method::multigrid}};
constexpr Choice<Regularization> regularizations[] = {{"polynomial", Regularization::polynomial},
                                                      {"sqrt", Regularization::square_root},
                                                      {"tanh", Regularization::log_cosh}};
constexpr Choice<Precon> preconditioners[] = {{"hessian-ssor", Precon::hessian_ssor},
                                              {"hessian-diagonal", Precon::hessian_diagonal},
                                              {"ssor", Precon::ssor},
                                              {"diagonal", Precon::diagonal},
                                              {"none", Precon::none},
                                              {"multigrid", Precon::multigrid}};
constexpr Choice<Step> steps[] = {
    {"exact", Step::exact}, {"newton", Step::newton}, {"falseposition", Step::false_position}};

template <class T, std::size_t count>
const char* name_of(T value, const Choice<T> (&choices)[count]) {
  for (const Choice<T>& c : choices)
    if (value == c.value) return c.name;
  return "";
}

}  // namespace frictioncg
