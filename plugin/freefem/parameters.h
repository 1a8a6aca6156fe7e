#pragma once
#include "freefem.h"

#include <string>

#include "../core/settings.h"

namespace frictioncg {

constexpr const char* version = "1.0";  ///< a script asks for frictionCGversion
constexpr const char* operator_name = "frictionalContactCG";
constexpr const char* constructor_name = "contactProblem";

/// The named parameters of the operator and of the constructor; each has its row in `parameters`.
enum Parameter {
  p_mu,
  p_mu2,
  p_direction,
  p_gap,
  p_normal,
  p_cohesion,
  p_shearmax,
  p_slidinglimit,
  p_bilateral,
  p_maxgap,
  p_smooth,
  p_weight,
  p_pivot,
  p_obstacles,
  p_motionfree,
  p_motion,
  p_motionload,
  p_motionold,
  p_motionforce,
  p_uold,
  p_at,
  p_forceold,
  p_init,
  p_start,
  p_method,
  p_newton,
  p_reg,
  p_regeps,
  p_precon,
  p_omega,
  p_step,
  p_tol,
  p_nbiter,
  p_memory,
  p_verb,
  p_status,
  p_residual,
  p_iterations,
  p_force,
  p_state,
  p_normals,
  p_distance,
  p_free,
  p_history,
  p_times,
  p_domain,
  p_obstacle,
  p_obstaclegap,
  p_obstaclenormal,
  p_obstacleforce,
  parameter_count
};

inline basicAC_F0::name_and_type parameters[] = {
    {"mu", &typeid(double)},                // friction coefficient
    {"mu2", &typeid(double)},               // across direction, mu being along it
    {"direction", &typeid(E_Array)},        // of orthotropic friction
    {"gap", &typeid(double)},               // [length]
    {"normal", &typeid(E_Array)},           // outward from the body
    {"cohesion", &typeid(double)},          // [force/area]
    {"shearmax", &typeid(double)},          // [force/area]
    {"slidinglimit", &typeid(double)},      // [force/area]
    {"bilateral", &typeid(bool)},           // no separation
    {"maxgap", &typeid(double)},            // of two bodies [length]
    {"smooth", &typeid(bool)},              // of two bodies: gap of the curved surfaces
    {"weight", &typeid(double)},            // of the forms: x, where they are axisymmetric
    {"pivot", &typeid(E_Array)},            // of an obstacle that moves
    {"obstacles", &typeid(KN_<long>)},      // labels of those that move
    {"motionfree", &typeid(KN_<long>)},     // 1: under a load; 0: given
    {"motion", &typeid(KN<double>*)},       // in and out [length, radians]
    {"motionload", &typeid(KN_<double>)},   // [force, moment]
    {"motionold", &typeid(KN_<double>)},    // of uold
    {"motionforce", &typeid(KN<double>*)},  // out, of an obstacle on the body
    {"uold", &typeid(KN_<double>)},         // [length]
    {"at", &typeid(KN_<double>)},           // of the geometry [length]
    {"forceold", &typeid(KN_<double>)},     // at `at`, an output force [force]
    {"init", &typeid(KN_<double>)},         // [length]
    {"start", &typeid(KN_<double>)},        // the same, where macro_ddm.idp takes the name init
    {"method", &typeid(string*)},           //
    {"newton", &typeid(bool)},              // condensed: on the laws themselves
    {"reg", &typeid(string*)},              //
    {"regeps", &typeid(double)},            // [length]
    {"precon", &typeid(string*)},           //
    {"omega", &typeid(double)},             //
    {"step", &typeid(string*)},             //
    {"tol", &typeid(double)},               //
    {"nbiter", &typeid(double)},            // a whole number
    {"memory", &typeid(double)},            // [GB]
    {"verb", &typeid(long)},                //
    {"status", &typeid(long*)},             // out
    {"residual", &typeid(double*)},         // out
    {"iterations", &typeid(long*)},         // out
    {"force", &typeid(KN<double>*)},        // out [force]
    {"state", &typeid(KN<long>*)},          // out
    {"normals", &typeid(KN<double>*)},      // out
    {"distance", &typeid(KN<double>*)},     // out, of two bodies [length]
    {"free", &typeid(long*)},               // out
    {"history", &typeid(KNM<double>*)},     // out
    {"times", &typeid(KN<double>*)},        // out [s]
    {"domain", &typeid(void)},              // of several processes: frictionCG-mpi has its type
    // of an obstacle beside pairs: its labels, in any form; gap; outward normal; force, an output
    {"obstacle", &typeid(KN_<long>)},
    {"obstaclegap", &typeid(double)},
    {"obstaclenormal", &typeid(E_Array)},
    {"obstacleforce", &typeid(KN<double>*)},
};
static_assert(sizeof(parameters) / sizeof(*parameters) == parameter_count, "one name each");

/// The parameters that give a contact problem its tangential laws.
constexpr Parameter frictions[] = {p_mu, p_cohesion, p_slidinglimit};
/// The tractions that bound friction, which contact integrates.
constexpr Parameter tractions[] = {p_cohesion, p_shearmax, p_slidinglimit};
/// What an obstacle beside pairs of bodies has.
constexpr Parameter of_obstacle_beside_pairs[] = {p_obstacle, p_obstaclegap, p_obstaclenormal,
                                                  p_obstacleforce};
/// What a new matrix of a contactproblem may bring along.
constexpr Parameter of_geometry[] = {p_normal, p_obstaclenormal, p_maxgap, p_smooth, p_weight};
/// What lets an obstacle move.
constexpr Parameter of_moving_obstacle[] = {p_pivot,      p_obstacles, p_motionfree, p_motion,
                                            p_motionload, p_motionold, p_motionforce};

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
T choose(const char* parameter, const std::string& value, const Choice<T> (&choices)[count]) {
  std::string known;
  for (const Choice<T>& c : choices) {
    if (value == c.name) return c.value;
    known += std::string(known.empty() ? "\"" : ", \"") + c.name + "\"";
  }
  throw IllegalInput(std::string(parameter) + " = \"" + value + "\" is unknown; choose from " +
                     known);
}

template <class T, std::size_t count>
const char* name_of(T value, const Choice<T> (&choices)[count]) {
  for (const Choice<T>& c : choices)
    if (value == c.value) return c.name;
  return "";
}

}  // namespace frictioncg
