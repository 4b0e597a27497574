#include "bench/report/suite.h"

#include "bench/in_child.h"
#include "core/error.h"
#include "tests/bench/made_up_case.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <new>
#include <string>
#include <unistd.h>

namespace smelt {
namespace {

using test::made_up_case;
using test::run_cases;

TEST(Suite, RunsEveryMethodAtEveryResolution) {
  const auto quick = run_cases({made_up_case("one"), made_up_case("two")});
  ASSERT_EQ(quick.size(), 2u);
  EXPECT_EQ(quick[0].problem.name, "one");
  ASSERT_EQ(quick[0].runs.size(), 6u);
  EXPECT_EQ(quick[0].runs[5].method, 1u);
  EXPECT_EQ(quick[0].runs[5].resolution, 40.0);
  EXPECT_DOUBLE_EQ(quick[0].runs[5].measured.error, 2.0 / 1600.0);
  EXPECT_EQ(run_cases({made_up_case("one")}, false)[0].runs.size(), 8u);
}

TEST(Suite, AFailureIsThatOfItsRunAlone) {
  const auto results = run_cases({made_up_case("one"), made_up_case("two")});
  for (const CaseResult& result : results) {
    EXPECT_TRUE(result.failed());
    for (const auto& run : result.runs)
      EXPECT_EQ(run.failure, run.method == 1 && run.resolution == 20.0 ? "no, thank you" : "");
  }
}

TEST(Suite, EveryRunHasOneThread) {
  Case problem = made_up_case("one");
  std::atomic<int> most = 0, n = 0;
  problem.run = [&](std::size_t, double) {
    most = std::max(most.load(), tbb::this_task_arena::max_concurrency());
    ++n;
    return Measurement{.error = 1.0};
  };
  run_cases({problem}, true, 3);
  EXPECT_EQ(n, 6);
  EXPECT_EQ(most, 1);
}

TEST(Suite, EndsWhereTheUserStops) {
  struct Impatient : Progress {
    bool should_stop() override { return n_messages > 0; }
    void message(const std::string&) override { ++n_messages; }
    int n_messages = 0;
  } impatient;
  int n_done = 0;
  EXPECT_THROW(run_suite({made_up_case("one")}, true, 1, impatient, [&](CaseResult) { ++n_done; }), Interrupted);
  EXPECT_EQ(impatient.n_messages, 1);
  EXPECT_EQ(n_done, 0);
}

TEST(Suite, PassesOnWhatItsCallerThrows) {
  Progress silent;
  EXPECT_THROW(run_suite({made_up_case("one"), made_up_case("two")}, true, 2, silent,
                         [](CaseResult) { fail("the disk is full"); }),
               Error);
}

// What goes wrong in a child process comes back as what it was, and nothing is printed twice.
TEST(InChild, SendsItsResultOrItsError) {
  EXPECT_EQ(run_in_child([] { return 42; }), 42);
  const auto failing = [](auto error) { return [error]() -> int { throw error; }; };
  const auto text_of = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  EXPECT_THROW(run_in_child(failing(DivergedError("NaN"))), DivergedError);
  EXPECT_THROW(run_in_child(failing(std::bad_alloc())), Error);
  EXPECT_THROW(run_in_child(failing(InternalError("ours"))), InternalError);
  EXPECT_EQ(text_of([&] { run_in_child(failing(Error("where, what, how"))); }), "where, what, how");
  EXPECT_NE(text_of([&] { run_in_child(failing(InternalError("ours"))); }).find("ours"), std::string::npos);
  EXPECT_NE(text_of([] { run_in_child([] { return kill(getpid(), SIGKILL); }); }).find("memory runs out"),
            std::string::npos);
  EXPECT_NE(text_of([] { run_in_child([] { return kill(getpid(), SIGTERM); }); }).find("signal 15"), std::string::npos);
}

TEST(InChild, PrintsOnce) {
  testing::internal::CaptureStdout();
  std::printf("once ");
  run_in_child([] {
    std::fflush(stdout);
    return 0;
  });
  std::fflush(stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "once ");
}

}  // namespace
}  // namespace smelt
