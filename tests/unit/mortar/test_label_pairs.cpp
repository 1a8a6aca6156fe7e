#include <gtest/gtest.h>

#include "../refusal.h"
#include "core/assembly/mortar/mortar.h"
#include "core/types.h"

using namespace frictioncg;
using namespace frictioncg::mortar;

namespace {

/// "1 2 on 3; 4 on 5 6"
std::string described(const std::vector<long>& slave, const std::vector<long>& master,
                      bool in_one_space = true) {
  std::string text;
  for (const Pair& pair : label_pairs(slave, master, in_one_space)) {
    if (!text.empty()) text += "; ";
    for (long s : pair.slave.labels) text += std::to_string(s) + " ";
    text += "on";
    for (long m : pair.master.labels) text += " " + std::to_string(m);
  }
  return text;
}

}  // namespace

TEST(LabelPairs, ListsOfOneLengthAreFacedPlaceByPlace) {
  EXPECT_EQ(described({1}, {2}), "1 on 2");
  EXPECT_EQ(described({1, 3}, {2, 4}), "1 on 2; 3 on 4");
  EXPECT_EQ(described({3, 1}, {4, 2}), "3 on 4; 1 on 2");
}

TEST(LabelPairs, ASingleLabelFacesAllOfTheOtherList) {
  EXPECT_EQ(described({1}, {4, 2, 3}), "1 on 4 2 3");
  EXPECT_EQ(described({3, 1, 2}, {4}), "3 1 2 on 4");
}

TEST(LabelPairs, LabelsNamedAgainAreJoined) {
  EXPECT_EQ(described({1, 1}, {2, 3}), "1 on 2 3");
  EXPECT_EQ(described({1, 2}, {3, 3}), "1 2 on 3");
  EXPECT_EQ(described({1, 1, 2, 2}, {3, 4, 4, 3}), "1 2 on 3 4");
  EXPECT_EQ(described({1, 1, 2, 2}, {4, 3, 3, 4}), "1 2 on 4 3");
  EXPECT_EQ(described({1, 1, 2}, {3, 4, 4}), "1 on 3 4; 2 on 4");
  EXPECT_EQ(described({1, 1}, {2, 2}), "1 on 2");
  EXPECT_EQ(described({1, 2}, {2, 3}), "1 on 2; 2 on 3");
}

TEST(LabelPairs, EqualListsOfOneSpaceAreOneSurface) {
  EXPECT_EQ(described({1, 2, 3}, {1, 2, 3}), "1 2 3 on 1 2 3");
  EXPECT_EQ(described({1, 2, 3}, {2, 1, 3}), "1 on 2; 2 on 1; 3 on 3");
  EXPECT_EQ(described({1, 2}, {1, 2}, false), "1 on 1; 2 on 2");
}

TEST(LabelPairs, OtherLengthsAreRefused) {
  EXPECT_EQ(frictioncg::test::refusal([] {
              label_pairs({1, 2, 3}, {4, 5}, true);
            }),
            "slave has 3 labels and master has 2; lists of one length are pairs, slave[k] facing "
            "master[k], and a single label faces all of the other list");
}
