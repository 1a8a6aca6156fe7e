#pragma once
#include "../freefem/freefem.h"

#include <charconv>

#include "../freefem/call.h"
#include "contact_domain.h"

namespace frictioncg {

/// The shortest text that stands for this number alone.
inline std::string exact(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}
inline std::string in_brackets(const std::vector<long>& labels) {
  std::string list;
  for (long label : labels) list += (list.empty() ? "[" : ", ") + std::to_string(label);
  return list + "]";
}

/// Obstacles beside pairs, and those that move, are of one process.
inline void refuse_obstacles(const Arguments& args) {
  args.refuse(of_obstacle_beside_pairs,
              "is of one process; with domain= a call has pairs or an obstacle, not both: mesh the "
              "obstacle as a master that Dirichlet conditions hold");
  args.refuse(of_moving_obstacle,
              "is of an obstacle that moves, which one process alone has; leave out domain=, or "
              "search over gap");
}

/// What a call says. What several processes do not do is refused by name; multigrid is what
/// method="auto" stands for.
inline std::unique_ptr<Call> read_call(Stack stack, const Arguments& args, const Expression b,
                                       bool two_bodies) {
  args.refuse({p_newton, p_reg, p_regeps, p_precon, p_omega, p_step, p_memory, p_threads},
              "belongs to methods of one process; with domain= there is multigrid alone");
  if (!two_bodies)
    args.refuse({p_distance}, "is that of two bodies; there is one, and an obstacle");
  args.refuse({p_times}, "is of one process; measure around the call, by mpiWtime()");
  auto call = std::make_unique<Call>(Call{stack, args, b});
  Method& method = call->settings.method;
  if (method != Method::automatic && method != Method::multigrid)
    refuse("method=\"", name_of(method, methods),
           "\" is of one process; with domain= there is method=\"multigrid\" alone: "
           "leave it out");
  method = Method::multigrid;
  return call;
}

/// A call of one process, without a domain.
template <class Solve>
AnyType solved_alone(const Solve& solve) {
  const AnyType result = solve();
  if (mpisize > 1) Meeting::of(MPI_COMM_WORLD)->stay_away();
  return result;
}

/// The beginning of a call: what each process finds by itself, and the comparison with the others,
/// who may wait for it already.
class Opening {
 public:
  /// form: which of the operators, and with which arguments in their places.
  Opening(const char* name, std::string form, const Arguments& args)
      : name_(name), form_(std::move(form)), args_(args) {}

  /// What may fail on one process alone, before it knows of the others.
  void alone(const std::function<void()>& body) {
    if (!own_part_.failed) own_part_ = attempt(body);
  }
  /// Whether the call is this process's own.
  bool is_alone() const { return !domain && !own_part_.failed; }

  /// Runs the rest of the call where it is the same on all processes, each of which has done its
  /// part of it. A process without a domain, which has failed, meets the others where they all are.
  template <class Body>
  AnyType with_others(Body body) const {
    if (!domain && mpisize <= 1) ExecError(std::string(name_) + ": " + own_part_.message);
    const auto world = domain ? nullptr : Meeting::of(MPI_COMM_WORLD);
    Meeting& here = domain ? domain->meeting() : *world;
    return together(name_, here.communicator(), [&] {
      items().compare(name_, here, own_part_, domain != nullptr);
      return body();
    });
  }

  int problem = 0;   ///< the contactproblem's number, or 0
  DomainPtr domain;  ///< null where this process has none
  std::vector<long> labels, masters;
  mortar::Options facing;      ///< of two bodies: maxgap and smooth
  std::unique_ptr<Call> call;  ///< null where a problem is posed
  PointLaws laws;              ///< before their values at nodes

 private:
  /// verb is of rank 0 alone.
  Comparison items() const {
    static_assert(parameter_count + 7 <= Comparison::most_items);
    Comparison all;
    all.add("the call", form_);
    for (int p = 0; p < parameter_count; ++p)
      if (p != p_verb) all.add(name_of(Parameter(p)), args_.has(Parameter(p)) ? "given" : "");
    all.mark();
    all.add("the contactproblem", problem > 0 ? "no. " + std::to_string(problem) : "");
    all.add("the domain", domain ? domain->name() : "");
    all.add("the list of labels", in_brackets(labels));
    all.add("the list of the master's labels", in_brackets(masters));
    all.add("maxgap", exact(facing.maxgap));
    all.add("smooth", facing.smooth ? "true" : "false");
    all.add("tol", call ? exact(call->settings.tol) : "");
    all.add("nbiter", call ? std::to_string(call->settings.nbiter) : "");
    all.add("bilateral", laws.bilateral ? "true" : "false");
    return all;
  }

  const char* name_;
  std::string form_;
  const Arguments& args_;
  Attempt own_part_;
};

}  // namespace frictioncg
