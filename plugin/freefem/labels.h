#pragma once
#include "freefem.h"

#include "errors.h"

namespace frictioncg {

/// The types of the forms in which a script may give labels: 1, int[int], [1, 2].
inline std::vector<aType> label_types() {
  return {atype<long>(), atype<KN_<long>>(), atype<E_Array>()};
}

/// One label of a script: FreeFEM would cast a real or a bool to a label that nobody has meant.
class LabelExpression {
 public:
  explicit LabelExpression(const C_F0& given) {
    const aType type = given.left();
    real_ = type == atype<double>() || type == atype<double*>();
    bool_ = type == atype<bool>() || type == atype<bool*>();
    expression_ = real_ ? to<double>(given) : bool_ ? to<bool>(given) : to<long>(given);
  }
  /// what: the argument, for the message.
  long operator()(Stack stack, const char* what) const {
    if (!real_ && !bool_) return GetAny<long>((*expression_)(stack));
    std::ostringstream m;
    m << what << " has ";
    if (real_)
      m << "the real " << GetAny<double>((*expression_)(stack));
    else
      m << "the bool " << (GetAny<bool>((*expression_)(stack)) ? "true" : "false");
    m << "; a label is a whole number, as in 1, [1, 2] or an int[int], and all that is no label is "
         "given by name, as in mu=0.3";
    throw IllegalInput(m.str());
  }

 private:
  bool real_ = false, bool_ = false;
  Expression expression_ = nullptr;
};

/// The labels of one boundary, as expressions.
class Labels {
 public:
  explicit Labels(const C_F0& argument) {
    const aType type = argument.left();
    if (const auto* list = dynamic_cast<const E_Array*>(argument.LeftValue())) {
      for (int k = 0; k < list->size(); ++k) labels_.emplace_back((*list)[k]);
    } else if (type == atype<KN_<long>>() || type == atype<KN<long>*>()) {
      array_ = to<KN_<long>>(argument);
    } else {
      labels_.emplace_back(argument);
    }
  }
  /// what: the side of the contact, for the message.
  std::vector<long> operator()(Stack stack, const char* what) const {
    return evaluated(what, [&] { return read(stack, what); });
  }

 private:
  std::vector<long> read(Stack stack, const char* what) const {
    std::vector<long> all;
    if (array_) {
      const KN_<long> list = GetAny<KN_<long>>((*array_)(stack));
      for (long k = 0; k < list.N(); ++k) all.push_back(list[k]);
    } else {
      for (const LabelExpression& label : labels_) all.push_back(label(stack, what));
    }
    if (all.empty())
      throw IllegalInput(std::string(what) + " is empty; name the boundary that may touch");
    return all;
  }

  std::vector<LabelExpression> labels_;
  Expression array_ = nullptr;  ///< in place of single ones
};

}  // namespace frictioncg
