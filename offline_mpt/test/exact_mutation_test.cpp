// The checker confirms what is right and refuses everything that was changed.
#include <cstdlib>

#include "map_in_memory.hpp"
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
    EXPECT_NE(refusalOfMap(changed).find("law"), std::string::npos) << k;
  }
}

TEST_F(Mutation, EveryPlaneEntryIsChecked) {
  for (std::size_t k = 0; k < content_.planes.size(); ++k) {
    MapContent changed = content_;
    changePlane(changed, k, 1e-6);
    EXPECT_NE(refusalOfMap(changed).find("plane"), std::string::npos) << k;
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
  int tried = 0;
  std::vector<std::string> lines = linesOf(certificate_);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].compare(0, 6, "facet ") != 0 || k % 3 != 0) continue;
    std::vector<std::string> fewer = lines;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    EXPECT_NE(refusal(sealed(joined(fewer, "\n") + "\n", map_), map_), "") << lines[k];
    ++tried;
  }
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, ANeighbourIsChecked) {
  int tried = 0;
  const std::size_t count = content_.regions.size();
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  if (words[3] != "next") return false;
                  words[5] = std::to_string((std::stoul(words[5]) + 1) % count);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, AnOriginIsChecked) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  const int row = std::stoi(words[2].substr(1));
                  words[2] = words[2][0] + std::to_string(words[2][0] == 'b' ? row ^ 1 : row + 1);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 20);
}

TEST_F(Mutation, AnInnerFacetIsNoEdgeOfTheDomain) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  if (words[3] == "domain") return false;
                  words.resize(5);
                  words[3] = "domain";
                  words[4] = words[2];
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, WeightsOfAnEdgeAreChecked) {
  for (const bool negate : {true, false}) {
    int tried = 0;
    EXPECT_NE(refusalOfLines(
                  "facet ",
                  [&](std::vector<std::string>& words) {
                    if (words[3] != "edge") return false;
                    words.back() = negate ? "-" + words.back() : words.back() + "0";
                    return words.size() > 7;  // one row alone may have any positive weight
                  },
                  tried),
              "");
    EXPECT_GT(tried, 0);
  }
}

TEST_F(Mutation, FarkasMultipliersAreChecked) {
  const auto negate = [](std::vector<std::string>& words) {
    words.back() = "-" + words.back();
    return true;
  };
  const auto enlarge = [](std::vector<std::string>& words) {
    words.back() += "000";
    return true;
  };
  const auto remove = [](std::vector<std::string>& words) {
    words[3] = "0";
    words.resize(4);
    return true;
  };
  const Change misplace = setting(4, "99");
  const Change unscale = setting(2, "0");
  int tried = 0;
  EXPECT_NE(refusalOfLines("follows ", negate, tried), "");
  EXPECT_GT(tried, 20);
  EXPECT_NE(refusalOfLines("follows ", enlarge, tried), "");
  EXPECT_NE(refusalOfLines("follows ", remove, tried), "");
  EXPECT_NE(refusalOfLines("follows ", misplace, tried), "");
  EXPECT_NE(refusalOfLines("follows ", unscale, tried), "");
}

TEST_F(Mutation, AnInnerPointIsChecked) {
  int tried = 0;
  EXPECT_NE(refusalOfLines("inside ", setting(1, "2"), tried), "");
  EXPECT_EQ(tried, static_cast<int>(content_.regions.size()));
}

TEST_F(Mutation, TheProgramIsChecked) {
  for (const char* key : {"H ", "F ", "A ", "b ", "S ", "E ", "C ", "c ", "box "}) {
    int tried = 0;
    EXPECT_NE(refusalOfLines(
                  key,
                  [](std::vector<std::string>& words) {
                    words[3] = words[3] == "0x1p+0" ? "0x1.8p+0" : "0x1p+0";
                    return true;
                  },
                  tried),
              "")
        << key;
    EXPECT_EQ(tried, 1);
  }
}

TEST_F(Mutation, AnIndefiniteHessianIsCaught) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "H ",
                [](std::vector<std::string>& words) {
                  words[3] = "-" + words[3];
                  return true;
                },
                tried)
                .find("semidefinite"),
            std::string::npos);
}

TEST_F(Mutation, AnotherMapIsCaught) {
  MapContent other = content_;
  other.name = "another";
  EXPECT_NE(refusal(certificate_, bytesOf(other)).find("another map"), std::string::npos);
}

/// A facet that several regions share: its cover is checked piece by piece.
class CoverMutation : public Mutation {
 protected:
  CoverMutation() : Mutation(smallLinearProgram()) {}
};

TEST_F(CoverMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_NE(certificate_.find(" cover N "), std::string::npos);
}

TEST_F(CoverMutation, CoversAreChecked) {
  const std::size_t count = content_.regions.size();
  int tried = 0;
  const auto is_cover = [](const std::vector<std::string>& words) {
    return words.size() > 5 && words[3] == "cover";
  };
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  if (!is_cover(words) || words[4] != "N") return false;
                  words[5] = std::to_string((std::stoul(words[5]) + 1) % count);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 0);
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  if (!is_cover(words)) return false;
                  words.pop_back();
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines(
                "facet ",
                [&](std::vector<std::string>& words) {
                  if (!is_cover(words)) return false;
                  words = {words[0], words[1], words[2], "cover",
                           "e",      "1",      "0",      "1"};  // "there is no such facet"
                  return true;
                },
                tried),
            "");
}

// Without a limit such a line uses up the stack.
TEST_F(CoverMutation, NestedCoversHaveALimit) {
  int tried = 0;
  const auto nest = [](std::vector<std::string>& words) {
    if (words.size() < 8 || words[3] != "cover" || words[4] != "N") return false;
    std::vector<std::string> again(words.begin() + 4, words.begin() + 6);
    for (std::size_t k = 6; words[k] == "z"; ++k) again.emplace_back("z");
    again.emplace_back("s");
    words.resize(4);
    for (int k = 0; k < 20000; ++k) words.insert(words.end(), again.begin(), again.end());
    return true;
  };
  EXPECT_NE(refusalOfLines("facet ", nest, tried).find("nested too deeply"), std::string::npos);
  EXPECT_GT(tried, 0);
}

}  // namespace
}  // namespace polyfly
