#include "assembly/mortar/label_pairs.h"

#include "types.h"

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

std::vector<LabelPair> label_pairs(const std::vector<long>& slave,
                                   const std::vector<long>& master) {
  if (slave.size() != master.size() && slave.size() != 1 && master.size() != 1)
    refuse(
        "slave has ", slave.size(), " labels and master has ", master.size(),
        "; lists of one length are pairs, slave[k] facing master[k], and a single label faces all "
        "of the other list");
  const std::size_t count = std::max(slave.size(), master.size());
  std::vector<LabelPair> of_slave;  // one slave label each
  for (std::size_t k = 0; k < count; ++k) {
    const long s = slave[slave.size() > 1 ? k : 0], m = master[master.size() > 1 ? k : 0];
    auto at = std::find_if(of_slave.begin(), of_slave.end(),
                           [s](const LabelPair& p) { return p.slave.front() == s; });
    if (at == of_slave.end()) at = of_slave.insert(at, {{s}, {}});
    add_once(at->master, m);
  }
  std::vector<LabelPair> pairs;
  for (const LabelPair& one : of_slave) {
    const auto at = std::find_if(pairs.begin(), pairs.end(), [&one](const LabelPair& p) {
      return same_labels(p.master, one.master);
    });
    if (at == pairs.end())
      pairs.push_back(one);
    else
      at->slave.push_back(one.slave.front());
  }
  return pairs;
}

}  // namespace frictioncg::mortar
