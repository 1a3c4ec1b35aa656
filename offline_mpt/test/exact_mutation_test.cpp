// The checker confirms what is right and refuses everything that was changed.
#include <cstdlib>

#include "mutation.hpp"

namespace polyfly {
namespace {

TEST_F(Mutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_EQ(refusal(sealed(certificate_, map_), map_), "");
}

TEST_F(Mutation, AnyByteOfTheCertificateIsCaught) {
  for (std::size_t at = 0; at<certificate_.size(); at += certificate_.size()> 4000 ? 7 : 1) {
    std::string changed = certificate_;
    changed[at] ^= static_cast<char>(1 + at % 7);
    EXPECT_NE(refusal(changed, map_), "") << at;
  }
}

TEST_F(Mutation, ACertificateThatWasCutOffIsCaught) {
  for (std::size_t size = 0; size < certificate_.size(); size += 97)
    EXPECT_NE(refusal(certificate_.substr(0, size), map_), "") << size;
}

TEST_F(Mutation, AnyByteOfTheMapIsCaught) {
  for (std::size_t at = 0; at < map_.size(); at += 11) {
    std::string changed = map_;
    changed[at] ^= static_cast<char>(1 + at % 7);
    EXPECT_NE(refusal(certificate_, changed), "") << at;
  }
}

// From here on all checksums are right: the proof itself must fail.

TEST_F(Mutation, EveryLawEntryIsChecked) {
  for (std::size_t k = 0; k < content_.laws.size(); ++k) {
    MapContent changed = content_;
    changed.laws[k] += 1e-6 * (1.0 + std::abs(changed.laws[k]));
    EXPECT_TRUE(holds(refusalOfMap(changed), "law")) << k;
  }
}

TEST_F(Mutation, EveryPlaneEntryIsChecked) {
  for (std::size_t k = 0; k < content_.planes.size(); ++k) {
    MapContent changed = content_;
    changePlane(changed, k, 1e-6);
    EXPECT_TRUE(holds(refusalOfMap(changed), "plane")) << k;
  }
}

TEST_F(Mutation, EveryRowIsChecked) {
  for (std::size_t k = 0; k < content_.rows.size(); ++k) {
    MapContent changed = content_;
    changed.rows[k] = -changed.rows[k];
    EXPECT_NE(refusalOfMap(changed), "") << k;
    const auto planes = static_cast<std::int32_t>(content_.planes.size() / 3);
    changed.rows[k] =
        content_.rows[k] > 0 ? content_.rows[k] % planes + 1 : -(-content_.rows[k] % planes + 1);
    EXPECT_NE(refusalOfMap(changed), "") << k;
  }
}

TEST_F(Mutation, EveryActiveRowIsChecked) {
  const int rows = program_.rowCount();
  for (std::size_t k = 0; k < content_.active.size(); ++k) {
    for (const int wrong : {(content_.active[k] + 1) % rows, (content_.active[k] + 5) % rows, rows}) {
      MapContent changed = content_;
      changed.active[k] = wrong;
      EXPECT_NE(refusalOfMap(changed), "") << k << " " << wrong;
    }
  }
}

TEST_F(Mutation, ADroppedRegionIsCaught) {
  MapContent changed = content_;
  changed.regions.pop_back();
  changed.nodes.clear();
  changed.leaves = {{0, 1}};
  changed.root = MapContent::kLeaf;
  changed.candidates = {0};
  changed.tests.clear();
  EXPECT_NE(refusalOfMap(changed), "");
  // Also where the certificate agrees that it never existed: a facet then has no region behind it.
  std::string shorter = certificate_;
  const std::size_t last = shorter.rfind("\nregion ");
  shorter.erase(last + 1, shorter.rfind("\nend ") - last);
  const std::size_t count = shorter.find("\nregions ") + 9;
  shorter.replace(count, shorter.find('\n', count) - count, std::to_string(changed.regions.size()));
  const std::string map = bytesOf(changed);
  EXPECT_NE(refusal(sealed(shorter, map), map), "");
}

TEST_F(Mutation, ARemovedFacetIsCaught) {
  for (std::size_t r = 0; r < content_.regions.size(); ++r) {
    MapContent changed = content_;
    changed.regions[r].row_count -= 1;
    changed.tests.clear();
    EXPECT_NE(refusalOfMap(changed), "") << r;
  }
  expectRefused("facet", leavingOut(), 11);
}

TEST_F(Mutation, ANeighbourIsChecked) {
  expectRefused("facet", where(3, "next", stepping(5, 1, content_.regions.size())), 11);
}

TEST_F(Mutation, AnOriginIsChecked) {
  const auto another = [](Words& words) {
    const int row = std::stoi(words[2].substr(1));
    words[2] = words[2][0] + std::to_string(words[2][0] == 'b' ? row ^ 1 : row + 1);
    return true;
  };
  expectRefused("facet", another, 21);
}

TEST_F(Mutation, AnInnerFacetIsNoEdgeOfTheDomain) {
  const auto move = [](Words& words) {
    const bool is_inner = words[3] != "domain";
    words = {words[0], words[1], words[2], "domain", words[2]};
    return is_inner;
  };
  expectRefused("facet", move, 11);
}

TEST_F(Mutation, WeightsOfAnEdgeAreChecked) {
  for (const Change& change : {negatingLast(), lengtheningLast("0")}) {
    // One row alone may have any positive weight.
    const auto ofSeveral = [&](Words& words) { return words.size() > 7 && change(words); };
    expectRefused("facet", where(3, "edge", ofSeveral));
  }
}

TEST_F(Mutation, FarkasMultipliersAreChecked) {
  const auto remove = [](Words& words) {
    words[3] = "0";
    words.resize(4);
    return true;
  };
  expectRefused("follows", negatingLast(), 21);
  for (const Change& change : {lengtheningLast("000"), Change(remove), setting(4, "99"), setting(2, "0")})
    expectRefused("follows", change);
}

TEST_F(Mutation, AnInnerPointIsChecked) {
  expectRefused("inside", setting(1, "2"), static_cast<int>(content_.regions.size()));
}

TEST_F(Mutation, TheProgramIsChecked) {
  const auto other = [](Words& words) {
    words[3] = words[3] == "0x1p+0" ? "0x1.8p+0" : "0x1p+0";
    return true;
  };
  for (const char* key : {"H", "F", "A", "b", "S", "E", "C", "c", "box"}) expectRefused(key, other);
}

TEST_F(Mutation, AnIndefiniteHessianIsCaught) {
  const auto negate = [](Words& words) {
    words[3] = "-" + words[3];
    return true;
  };
  expectRefused("H", negate, 1, "semidefinite");
}

TEST_F(Mutation, AnotherMapIsCaught) {
  MapContent other = content_;
  other.name = "another";
  EXPECT_TRUE(holds(refusal(certificate_, bytesOf(other)), "another map"));
}

/// A facet that several regions share: its cover is checked piece by piece.
class CoverMutation : public Mutation {
 protected:
  CoverMutation() : Mutation(once([] { return smallLinearProgram(); })) {}
};

TEST_F(CoverMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_TRUE(holds(certificate_, " cover N "));
}

TEST_F(CoverMutation, CoversAreChecked) {
  expectRefused("facet", where(4, "N", where(3, "cover", stepping(5, 1, content_.regions.size()))));
  expectRefused("facet", where(3, "cover", droppingLast()));
  const auto claimThereIsNone = [](Words& words) {
    words = {words[0], words[1], words[2], "cover", "e", "1", "0", "1"};
    return true;
  };
  expectRefused("facet", where(3, "cover", claimThereIsNone));
}

// Without a limit such a line uses up the stack.
TEST_F(CoverMutation, NestedCoversHaveALimit) {
  const auto nest = [](Words& words) {
    if (words.size() < 8 || words[3] != "cover" || words[4] != "N") return false;
    Words again(words.begin() + 4, words.begin() + 6);
    for (std::size_t k = 6; words[k] == "z"; ++k) again.emplace_back("z");
    again.emplace_back("s");
    words.resize(4);
    for (int k = 0; k < 20000; ++k) words.insert(words.end(), again.begin(), again.end());
    return true;
  };
  expectRefused("facet", nest, 1, "nested too deeply");
}

}  // namespace
}  // namespace polyfly
