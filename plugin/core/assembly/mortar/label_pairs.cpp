#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

namespace {

void add_once(std::vector<long>& labels, long label) {
  if (std::find(labels.begin(), labels.end(), label) == labels.end()) labels.push_back(label);
}

bool same_labels(std::vector<long> a, std::vector<long> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

}  // namespace

std::vector<Pair> label_pairs(const std::vector<long>& slave, const std::vector<long>& master) {
  if (slave.size() != master.size() && slave.size() != 1 && master.size() != 1)
    refuse(
        "slave has ", slave.size(), " labels and master has ", master.size(),
        "; lists of one length are pairs, slave[k] facing master[k], and a single label faces all "
        "of the other list");
  const std::size_t count = std::max(slave.size(), master.size());
  std::vector<Pair> of_slave;  // one slave label each
  for (std::size_t k = 0; k < count; ++k) {
    const long s = slave[slave.size() > 1 ? k : 0], m = master[master.size() > 1 ? k : 0];
    auto at = std::find_if(of_slave.begin(), of_slave.end(),
                           [s](const Pair& p) { return p.slave.labels.front() == s; });
    if (at == of_slave.end()) {
      at = of_slave.insert(at, Pair());
      at->slave.labels = {s};
    }
    add_once(at->master.labels, m);
  }
  std::vector<Pair> pairs;
  for (const Pair& one : of_slave) {
    const auto at = std::find_if(pairs.begin(), pairs.end(), [&one](const Pair& p) {
      return same_labels(p.master.labels, one.master.labels);
    });
    if (at == pairs.end())
      pairs.push_back(one);
    else
      at->slave.labels.push_back(one.slave.labels.front());
  }
  return pairs;
}

}  // namespace frictioncg::mortar
