#pragma once
// Starts the real binary, and keeps what it says.

#include "io/atomic_file.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace smelt {

namespace fs = std::filesystem;

struct Result {
  int status = -1;  ///< exit status, or 128 + signal
  std::string out;
  std::string err;
};

/// A folder of its own for each test.
class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("smelt_cli_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Starts the program; `before_exec` runs in the child.
  pid_t start(const std::vector<std::string>& arguments, const std::function<void()>& before_exec = {}) {
    const pid_t child = fork();
    if (child != 0) return child;
    const auto redirect = [&](const char* name, int fd) {
      const int file = open((folder_ / name).c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
      dup2(file, fd);
      close(file);
    };
    redirect("stdout.txt", STDOUT_FILENO);
    redirect("stderr.txt", STDERR_FILENO);
    if (before_exec) before_exec();
    std::vector<char*> argv = {const_cast<char*>(SMELT_PROGRAM)};
    for (const auto& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    execv(SMELT_PROGRAM, argv.data());
    _exit(99);
  }

  Result finish(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(folder_ / "stdout.txt"),
            read_file(folder_ / "stderr.txt")};
  }

  Result run(const std::vector<std::string>& arguments, const std::function<void()>& before_exec = {}) {
    return finish(start(arguments, before_exec));
  }

  /// A small bunny that takes seconds.
  std::string small_scene() {
    const fs::path path = folder_ / "small.toml";
    std::ofstream(path) << R"(
[shot]
name = "small"
frames = 4
fps = 24
[particles]
count = 700
[solver]
sound_speed_m_s = 20.0
[time_step]
courant = 0.4
[[material]]
name = "wax"
density_kg_m3 = 900
viscosity = { law = "smd", index = 1.0, yield_stress_Pa = { cold = 4e4, hot = 10.0 }, consistency_Pa_sn = { cold = 4e3, hot = 100.0 }, jump_number = { cold = 1000, hot = 15 } }
heat = { diffusivity_m2_s = 1e-3, cold_K = 330.0, hot_K = 360.0, specific_heat_J_kgK = 2000, latent_heat_J_kg = 1e5, emissivity = 0.9 }
[[body]]
mesh = "assets/bunny.obj"
material = "wax"
scale = 0.1
stand_at_y_m = 0.0
temperature_K = { bottom = 300.0, top = 400.0 }
[[collider]]
mesh = "ground"
temperature_K = 290
[ambient]
temperature_K = 290
heat_transfer_W_m2K = 500
[[heat_source]]
position_m = [0.0, 0.9, 0.0]
radius_m = 0.4
power_W = 20000
[camera]
width = 160
height = 90
)";
    return path.string();
  }

  std::string output(const char* name) { return (folder_ / name).string(); }

  /// Byte for byte.
  void expect_same_files(const fs::path& a, const fs::path& b, std::size_t expected_count) {
    std::size_t n = 0;
    for (const auto& entry : fs::directory_iterator(a)) {
      ++n;
      EXPECT_TRUE(read_file(entry.path()) == read_file(b / entry.path().filename()))
          << entry.path() << " and its twin differ";
    }
    EXPECT_EQ(n, expected_count);
  }

  fs::path folder_;
};

}  // namespace smelt
