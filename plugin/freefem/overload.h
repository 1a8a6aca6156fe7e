#pragma once
#include "freefem.h"

namespace frictioncg {

/// One form of the arguments of an operator: FreeFEM chooses among them by their types.
class Overload : public OneOperator {
 public:
  using Make = std::function<E_F0*(const basicAC_F0&)>;
  Overload(aType result, const std::vector<aType>& types, Make make)
      : OneOperator(result, Types(types)), make_(std::move(make)) {}
  E_F0* code(const basicAC_F0& args) const override { return make_(args); }

 private:
  struct Types : ArrayOfaType {
    explicit Types(const std::vector<aType>& types) {
      n = static_cast<int>(types.size());
      t = new aType[n];  // ArrayOfaType deletes it
      std::copy(types.begin(), types.end(), t);
    }
  };
  Make make_;
};

}  // namespace frictioncg
