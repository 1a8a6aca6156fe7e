// frictionCG for several processes: what frictionCG registers, with domain=, and the type
// contactdomain that createMat of FreeFEM's macro_ddm.idp fills.  The numerics are those of core/,
// on matrices and multigrid of PETSc.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "../freefem/freefem.h"

#include "../freefem/load.h"
#include "../freefem/memory.h"
#include "../freefem/usage.h"
#include "shared_operators.h"
#include "shared_pair_site.h"

namespace frictioncg {
namespace {

template <class Operator>
void add_shared(const char* name, const std::vector<aType>& site,
                const std::function<E_F0*(const basicAC_F0&, int)>& make) {
  std::vector<aType> types = Operator::before_site();
  const int first = static_cast<int>(types.size());
  types.insert(types.end(), site.begin(), site.end());
  Global.Add(name, "(",
             new Overload(atype<typename Operator::Result>(), types,
                          [=](const basicAC_F0& args) { return make(args, first); }));
}

LabelForm form_of(aType type) {
  for (LabelForm form : label_forms)
    if (type == type_of(form)) return form;
  throw std::logic_error("labels of an unknown type");
}

/// The operators for a space of V and an obstacle, or two bodies.
template <class V>
void add_sites() {
  for_each_site<V>([](const std::vector<aType>& types, const MakeSite& make) {
    const auto shared = [types](const basicAC_F0& args, int first) -> std::shared_ptr<SharedSite> {
      const LabelForm form = form_of(types[1]);
      if (types.size() == 2) return std::make_shared<SharedObstacleSite<V>>(args, first, form);
      if (types.size() == 3)
        return std::make_shared<SharedOneSpaceSite<V>>(args, first, form, form_of(types[2]));
      return std::make_shared<SharedTwoSpaceSite<V>>(args, first, form, form_of(types[3]));
    };
    add_shared<SharedSolveOnce>(operator_name, types, [=](const basicAC_F0& args, int first) {
      return new SharedSolveOnce(args, make(args, first), shared(args, first));
    });
    add_shared<SharedConstruct>(constructor_name, types, [=](const basicAC_F0& args, int first) {
      return new SharedConstruct(args, make(args, first), shared(args, first));
    });
  });
}

constexpr const char* plugin_name = "frictionCG-mpi";

void end() {
  try {
    if (mpisize > 1) meet_at_end(plugin_name);
    end_petsc();
  } catch (const std::bad_alloc&) {
    end_all(MPI_COMM_WORLD, plugin_name, not_enough_memory);
  }
}

void load() {
  check_version();
  if (is_loaded())
    throw ErrorLoad(
        "frictionCG-mpi has all that frictionCG has; load it first, before frictionCG and its "
        "macros (frictionCG.idp)",
        1);
  if (!take_buffer_of_blas()) end_all(MPI_COMM_WORLD, plugin_name, not_enough_memory);
  register_contactproblem();
  register_contactdomain();
  // as an error of FreeFEM's: its end meets that of the process that could not, and mpirun of Open
  // MPI hangs where others abort meanwhile
  if (mpisize > 1 && !meet_at_load())
    throw ErrorLoad(
        "frictionCG-mpi: not loaded on all processes; is it there for each of them, and memory for "
        "it?",
        1);
  ff_atend(end);
  add_sites<v_fes>();
  add_sites<v_fes3>();
  Global.Add(operator_name, "(", new OneOperatorCode<SharedSolveIncrement>());
  Global.Add(operator_name, "(", new OneOperatorCode<Renew>());
  add_usage();
  add_version();
}

}  // namespace
}  // namespace frictioncg

LOADFUNC(frictioncg::load)
