#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace end_to_end
{
  namespace fs = std::filesystem;

  std::vector<std::string> command_of(const Launch &what,
                                      const fs::path &directory,
                                      const std::vector<std::string> &more)
  {
    std::vector<std::string> command;
    if (what.ranks > 1)
      command = {NSFD_MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n",
                 std::to_string(what.ranks)};
    command.insert(command.end(), {what.program, what.file.string(), "--quiet",
                                   "--output", directory.string()});
    if (!what.report)
      command.insert(command.end(), {"--set", "Output/report=false"});
    for (const std::string &assignment : what.set)
      command.insert(command.end(), {"--set", assignment});
    command.insert(command.end(), what.more.begin(), what.more.end());
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  Result resume(const Workspace &workspace, const std::string &name,
                const Launch &what)
  {
    Result result;
    result.directory = workspace.path() / name;
    result.outcome = Process(command_of(what, result.directory, {"--resume"}),
                             workspace.path())
                         .wait(what.seconds);
    result.history_text = read_text(result.directory / "history.csv");
    result.history = History(result.history_text);
    result.summary = nlohmann::json::parse(
        read_text(result.directory / "summary.json"), nullptr, false);
    return result;
  }

  Launch with(Launch launch, const std::vector<std::string> &settings)
  {
    for (const std::string &setting : settings) {
      const std::string name = setting.substr(0, setting.find('=') + 1);
      auto &set = launch.set;
      set.erase(std::remove_if(set.begin(), set.end(),
                               [&](const std::string &old) {
                                 return old.compare(0, name.size(), name) == 0;
                               }),
                set.end());
      set.push_back(setting);
    }
    return launch;
  }

  Launch storing(Launch what, const unsigned int steps)
  {
    return with(std::move(what),
                {"Output/checkpoint every steps=" + std::to_string(steps)});
  }

  fs::path newest(const fs::path &directory)
  {
    return directory / "checkpoint.h5";
  }

  fs::path previous(const fs::path &directory)
  {
    return directory / "checkpoint_previous.h5";
  }

  void go_on(const Workspace &workspace, const Launch &before,
             const Launch &after, const Result &whole, Result &resumed)
  {
    const auto steps = unsigned(0.4 * whole.number("steps")) + 1;
    const Result stored = run(workspace, "resumed", storing(before, steps));
    ASSERT_TRUE(stored.completed()) << stored.description();
    // at 0.4, 0.8 and the end
    fs::rename(previous(stored.directory), newest(stored.directory));
    resumed = resume(workspace, "resumed", storing(after, steps));
    ASSERT_TRUE(resumed.completed()) << resumed.description();
  }

  bool wait_for_rows(const fs::path &directory, const long n)
  {
    for (unsigned int i = 0; i < 6000; ++i) {
      const std::string text = read_text(directory / "history.csv");
      if (std::count(text.begin(), text.end(), '\n') - 1 >= n)
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
} // namespace end_to_end
