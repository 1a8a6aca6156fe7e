#include "gradient/release_rule.h"

#include "gradient/gc1.h"
#include "gradient/gc2.h"
#include "gradient/gc3.h"
#include "gradient/gcx.h"

namespace frictioncg {

std::unique_ptr<ReleaseRule> make_release_rule(const Settings& settings, const System& system) {
  switch (settings.method) {
    case Method::gc1:
      return std::make_unique<Gc1>();
    case Method::gc2:
      return std::make_unique<Gc2>();
    case Method::gcx:
      return std::make_unique<Gcx>(system);
    default:
      return std::make_unique<Gc3>(settings.partial);
  }
}

}  // namespace frictioncg
