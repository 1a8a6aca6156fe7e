#pragma once
#include "freefem.h"

#include <vector>

#include "../core/types.h"

namespace frictioncg {

/// The forms in which a script may give labels, told apart by FreeFEM's types: 1, int[int], [1, 2].
enum class LabelForm { number, array, list };
constexpr LabelForm label_forms[] = {LabelForm::number, LabelForm::array, LabelForm::list};

inline aType type_of(LabelForm form) {
  switch (form) {
    case LabelForm::array:
      return atype<KN_<long>>();
    case LabelForm::list:
      return atype<E_Array>();
    default:
      return atype<long>();
  }
}

/// The labels of one boundary, as expressions.
class Labels {
 public:
  Labels(const C_F0& argument, LabelForm form) : form_(form) {
    if (form == LabelForm::list) {
      const E_Array* list = dynamic_cast<const E_Array*>(argument.LeftValue());
      for (int k = 0; list && k < list->size(); ++k) expressions_.push_back(to<long>((*list)[k]));
    } else {
      expressions_.push_back(form == LabelForm::array ? to<KN_<long>>(argument)
                                                      : to<long>(argument));
    }
  }
  /// what: the side of the contact, for the message.
  std::vector<long> operator()(Stack stack, const char* what) const {
    std::vector<long> all;
    if (form_ == LabelForm::array) {
      const KN_<long> list = GetAny<KN_<long>>((*expressions_[0])(stack));
      for (long k = 0; k < list.N(); ++k) all.push_back(list[k]);
    } else {
      for (Expression e : expressions_) all.push_back(GetAny<long>((*e)(stack)));
    }
    if (all.empty())
      throw IllegalInput(std::string(what) + " is empty; name the boundary that may touch");
    return all;
  }

 private:
  LabelForm form_;
  std::vector<Expression> expressions_;
};

}  // namespace frictioncg
