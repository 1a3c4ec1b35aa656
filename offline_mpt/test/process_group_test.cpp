// Explorations divided among processes, here threads with letter boxes: the same bytes as one, whatever
// happens.
#include "offline_mpt/process_group.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "error_of.hpp"
#include "holds.hpp"
#include "offline_mpt/encode.hpp"
#include "process_members.hpp"
#include "random_program.hpp"
#include "region_maps/write_map.hpp"
#include "same_regions.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

/// Explores as process 0 while the others play their parts.
Partition exploreWith(const ParametricProgram& program, ExploreOptions options,
                      const std::vector<Part>& parts) {
  return leadWith(parts, [&](Member& leader) {
    options.group = &leader;
    return explore(program, options);
  });
}

class ProcessGroupTest : public ::testing::Test {
 protected:
  ProcessGroupTest() { options_.checkpoint = folder_.file("checkpoint"); }

  Part assistant(int threads = 1) const {
    return [this, threads](Member& member) {
      ExploreOptions options;
      options.threads = threads;
      runWorkerProcess(program_, options, member);
    };
  }

  std::string refusal(const Part& part) {
    return errorOf([&] { exploreWith(program_, options_, {part}); });
  }

  const ParametricProgram program_ = randomProgram(8, 24, 3, 5);
  const Partition whole_ = explore(program_);
  ScratchFolder folder_;
  ExploreOptions options_;
};

TEST_F(ProcessGroupTest, AnyNumberOfProcessesGivesTheSameBytes) {
  const std::vector<std::byte> bytes = layOut(encode(program_, whole_));
  for (int others = 1; others <= 3; ++others) {
    options_.threads = 1 + others % 2;
    const std::vector<Part> parts(static_cast<std::size_t>(others), assistant(1 + others / 2));
    const Partition partition = exploreWith(program_, options_, parts);
    expectSameRegions(partition, whole_);
    EXPECT_EQ(partition.stats.lost_process, 0);
    EXPECT_EQ(layOut(encode(program_, partition)), bytes);
  }
}

TEST_F(ProcessGroupTest, StoppedAndResumedGivesTheSameBytes) {
  for (const std::uint64_t cut : {1u, 17u, 60u, 111u}) {
    ASSERT_LT(cut, whole_.regions.size());
    options_.region_limit = cut;
    options_.resume = false;
    EXPECT_EQ(exploreWith(program_, options_, {assistant(), assistant()}).regions.size(), cut);
    options_.region_limit = whole_.regions.size() + 1;
    options_.resume = true;
    expectSameRegions(
        cut % 2 == 0 ? exploreWith(program_, options_, {assistant()}) : explore(program_, options_), whole_);
  }
}

// It takes work, answers nothing and ends.
void takeAndDie(const ParametricProgram& program, Member& member) {
  class Thief : public ProcessGroup {
   public:
    explicit Thief(Member& thief) : member_(thief) {}
    int rank() const override { return member_.rank(); }
    int size() const override { return member_.size(); }
    void send(int to, std::vector<std::byte> message) override {
      // The first message announces the process. No other is sent.
      if (sent_++ == 0) member_.send(to, std::move(message));
    }
    bool receive(int& from, std::vector<std::byte>& message) override {
      if (!member_.receive(from, message)) return false;
      // The process dies at the first task.
      if (message.size() > 1) member_.die();
      return true;
    }
    bool lost(int rank) override { return member_.lost(rank); }

   private:
    Member& member_;
    int sent_ = 0;
  } thief(member);
  runWorkerProcess(program, {}, thief);
}

TEST_F(ProcessGroupTest, LosingAProcessLeavesACheckpoint) {
  const Partition part =
      exploreWith(program_, options_, {[this](Member& member) { takeAndDie(program_, member); }});
  ASSERT_EQ(part.status, ExploreStatus::kInterrupted);
  EXPECT_EQ(part.stats.lost_process, 1);
  EXPECT_LT(part.regions.size(), whole_.regions.size());
  ASSERT_GT(part.regions.size(), 0u);
  options_.resume = true;
  expectSameRegions(explore(program_, options_), whole_);
}

TEST_F(ProcessGroupTest, AProcessWithAnotherProblemIsRefused) {
  ParametricProgram other = program_;
  other.b(0) += 1e-12;
  const Part stranger = [&other](Member& member) { runWorkerProcess(other, {}, member); };
  EXPECT_EQ(refusal(stranger), "process 1: has read another problem");
  other.H(0, 0) = -1.0;
  EXPECT_TRUE(holds(refusal(stranger), "process 1: "));
}

TEST_F(ProcessGroupTest, AProcessThatCannotAssistSaysWhy) {
  const Part unable = [](Member& member) { reportFailure("x.json: cannot be read", member); };
  EXPECT_EQ(refusal(unable), "process 1: x.json: cannot be read");
}

/// What process 0 throws where each of three tells of another input, and how many of the others throw too.
std::pair<std::string, int> inputsRefused(const std::vector<std::string>& inputs) {
  std::atomic<int> refused{0};
  std::vector<Part> parts;
  for (std::size_t k = 1; k < inputs.size(); ++k) {
    parts.emplace_back([&inputs, &refused, k](Member& member) {
      if (errorOf([&] { requireSameInput(inputs[k], member); }) != "no error") ++refused;
    });
  }
  const std::string error = errorOf([&] {
    leadWith(parts, [&](Member& leader) {
      if (!inputs.front().empty()) requireSameInput(inputs.front(), leader);
      return 0;
    });
  });
  return {error, refused};
}

TEST(ProcessGroupInput, EachTextIsNamedWithItsProcesses) {
  EXPECT_EQ(inputsRefused({"a", "a", "a"}), std::pair(std::string("no error"), 0));
  EXPECT_EQ(
      inputsRefused({"a", "b", "a", "b"}),
      std::pair(
          std::string("the processes of the job have not read the same: process 0, 2: a; process 1, 3: b"),
          3));
  EXPECT_EQ(inputsRefused({"", "b", "b"}), std::pair(std::string("no error"), 2));  // process 0 ends first
}

}  // namespace
}  // namespace polyfly
