// Includes point one way: core <- {io, surfacing, render} <- scenes <- bench <- cli; the middle three never include
// each other.

#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

const std::map<std::string, std::set<std::string>> allowed_includes = {
    {"core", {"core"}},
    {"io", {"core", "io"}},
    {"surfacing", {"core", "surfacing"}},
    {"render", {"core", "render"}},
    {"scenes", {"core", "io", "surfacing", "render", "scenes"}},
    {"bench", {"core", "io", "surfacing", "render", "scenes", "bench"}},
    {"cli", {"core", "io", "surfacing", "render", "scenes", "bench", "cli"}},
};

/// The folder an include line names, or nothing.
std::string included_folder(const std::string& line) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*[<"]([a-z]+)/.*)re");
  std::smatch match;
  return std::regex_match(line, match, pattern) ? match[1].str() : std::string();
}

TEST(Layering, IncludesPointOneWay) {
  int n_files = 0, n_checked = 0;
  for (const auto& [folder, allowed] : allowed_includes) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(smelt::source_folder() / folder)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      ++n_files;
      std::ifstream file(entry.path());
      int number = 0;
      for (std::string line; std::getline(file, line);) {
        ++number;
        const std::string target = included_folder(line);
        if (!allowed_includes.contains(target)) continue;
        ++n_checked;
        EXPECT_TRUE(allowed.contains(target))
            << entry.path() << ":" << number << ": " << folder << " must not include " << target;
      }
    }
  }
  EXPECT_GT(n_files, 60);
  EXPECT_GT(n_checked, 150);
}

TEST(Layering, CoreOpensNoFileAndPrintsNothing) {
  const std::set<std::string> banned = {"<fstream>", "<iostream>", "<cstdio>", "<chrono>", "<filesystem>"};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(smelt::source_folder() / "core")) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);)
      for (const auto& header : banned)
        EXPECT_FALSE(line.starts_with("#include " + header)) << entry.path() << " includes " << header;
  }
}

TEST(Layering, OpenVdbInputAndOutputStayInIo) {
  for (const auto& [folder, allowed] : allowed_includes) {
    if (folder == "io") continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(smelt::source_folder() / folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);)
        EXPECT_EQ(line.find("#include <openvdb/io/"), std::string::npos) << entry.path();
    }
  }
}

}  // namespace
