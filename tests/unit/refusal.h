#pragma once
// What is said where input is refused.
#include <string>

#include "core/types.h"

namespace frictioncg::test {

/// Of IllegalInput that `what` throws; empty where it throws none.
template <class What>
std::string refusal(const What& what) {
  try {
    what();
  } catch (const IllegalInput& e) {
    return e.what();
  }
  return "";
}

inline bool names(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace frictioncg::test
