#include "program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <limits>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace end_to_end
{
  namespace fs = std::filesystem;

  fs::path scene(const std::string &name)
  {
    return fs::path(NSFD_SOURCE_DIR) / "prm" / "verification" / (name + ".prm");
  }

  std::string with_mesh(const std::string &file)
  {
    return "Mesh/file=" + (prm_folder() / "meshes" / file).string();
  }

  fs::path benchmark(const std::string &name)
  {
    return fs::path(NSFD_SOURCE_DIR) / "prm" / "benchmarks" / (name + ".prm");
  }

  fs::path torn_plate() { return benchmark("torn_plate"); }

  fs::path prm_folder() { return fs::path(NSFD_SOURCE_DIR) / "prm"; }

  std::string read_text(const fs::path &file)
  {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  void write_text(const fs::path &file, const std::string &text)
  {
    std::ofstream(file, std::ios::binary) << text;
  }

  std::vector<std::string> files_below(const fs::path &directory)
  {
    std::vector<std::string> names;
    for (const auto &entry : fs::recursive_directory_iterator(directory))
      names.push_back(entry.path().lexically_relative(directory).string());
    std::sort(names.begin(), names.end());
    return names;
  }

  namespace
  {
    /**
     * What MPI keeps of the processes in a directory. One per test: they remove
     * what they share as they end, while others begin.
     */
    fs::path of_mpi(const fs::path &directory)
    {
      return directory.string() + "_mpi";
    }
  } // namespace

  Workspace::Workspace()
  {
    const auto *test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(test->test_suite_name()) + "." + test->name();
    std::replace(name.begin(), name.end(), '/', '_');
    path_ = fs::temp_directory_path() /
            ("nsfd_" + std::to_string(getpid()) + "_" + name);
    fs::remove_all(path_);
    fs::create_directories(path_);
    fs::create_directories(of_mpi(path_));
  }

  Workspace::~Workspace()
  {
    std::error_code error;
    fs::remove_all(of_mpi(path_), error);
    if (testing::Test::HasFailure())
      std::cout << "files of this test: " << path_ << "\n";
    else
      fs::remove_all(path_, error);
  }

  Process::Process(const std::vector<std::string> &command,
                   const fs::path &directory, const Environment environment)
      : out_(directory / ".out"), err_(directory / ".err")
  {
    std::vector<char *> arguments;
    for (const std::string &word : command)
      arguments.push_back(const_cast<char *>(word.c_str()));
    arguments.push_back(nullptr);
    std::cout << std::flush;
    pid_ = fork();
    if (pid_ < 0)
      throw std::runtime_error("fork failed");
    if (pid_ > 0)
      return;

    setpgid(0, 0);
    const std::string own = of_mpi(directory).string();
    const std::pair<const char *, const char *> settings[] = {
        {"OMPI_MCA_orte_tmpdir_base", own.c_str()},
        {"OMPI_ALLOW_RUN_AS_ROOT", "1"},
        {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
        {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
        {"OMPI_MCA_mpi_yield_when_idle", "1"},
        {"OMPI_MCA_btl_vader_single_copy_mechanism", "none"},
        {"OMPI_MCA_pml", "ob1"}, // not asking for networks saves 0.2 s a run
        {"OMPI_MCA_ess_singleton_isolated", "1"}};
    for (const auto &[name, value] : settings)
      unsetenv(name);
    if (environment == Environment::prepared)
      for (const auto &[name, value] : settings)
        // under mpirun a rank is no singleton
        if (command[0] != NSFD_MPIRUN ||
            std::strcmp(name, "OMPI_MCA_ess_singleton_isolated") != 0)
          setenv(name, value, 1);
    const auto redirect = [](const fs::path &file, const int descriptor) {
      const int target = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      dup2(target, descriptor);
      close(target);
    };
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    if (chdir(directory.c_str()) == 0)
      execvp(arguments[0], arguments.data());
    _exit(127);
  }

  Process::~Process()
  {
    if (is_running())
      wait(0.);
  }

  bool Process::is_running()
  {
    if (!ended_)
      ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !ended_;
  }

  void Process::send(const int signal) const { kill(pid_, signal); }

  Outcome Process::wait(const double seconds)
  {
    using Clock = std::chrono::steady_clock;
    const auto elapsed = [start = Clock::now()] {
      return std::chrono::duration<double>(Clock::now() - start).count();
    };
    while (is_running() && elapsed() < seconds)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    Outcome outcome;
    if (is_running()) {
      kill(-pid_, SIGTERM); // mpirun ends its ranks
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      if (is_running()) {
        kill(-pid_, SIGKILL);
        waitpid(pid_, &status_, 0);
        ended_ = true;
      }
    } else
      outcome.exit_code =
          WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    outcome.out = read_text(out_);
    outcome.err = read_text(err_);
    fs::remove(out_);
    fs::remove(err_);
    return outcome;
  }

  Outcome nsfd(const Workspace &workspace,
               const std::vector<std::string> &arguments,
               const Environment environment)
  {
    std::vector<std::string> command = {NSFD_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return Process(command, workspace.path(), environment).wait(60.);
  }

  History::History(const std::string &text)
  {
    std::istringstream stream(text);
    std::string line, cell;
    std::getline(stream, line);
    std::istringstream header(line);
    while (std::getline(header, cell, ','))
      names_.push_back(cell);
    columns_.resize(names_.size());
    while (std::getline(stream, line)) {
      std::istringstream row(line);
      for (auto &column : columns_) {
        std::getline(row, cell, ',');
        column.push_back(std::strtod(cell.c_str(), nullptr));
      }
    }
  }

  const std::vector<double> &History::operator[](const std::string &name) const
  {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end())
      throw std::out_of_range("history.csv has no column " + name);
    return columns_[at - names_.begin()];
  }

  const std::vector<std::string> &History::energy_lines()
  {
    static const std::vector<std::string> lines = {
        "kinetic", "elastic", "cohesive", "damage",    "friction",
        "viscous", "plastic", "impact",   "numerical", "work"};
    return lines;
  }

  double History::largest_energy() const
  {
    double largest = 0.;
    for (const std::string &line : energy_lines())
      for (const double value : (*this)[line])
        largest = std::max(largest, std::abs(value));
    return largest;
  }

  namespace
  {
    double number_in(const nlohmann::json &object, const std::string &name)
    {
      const auto at = object.find(name);
      return at != object.end() && at->is_number()
                 ? at->get<double>()
                 : std::numeric_limits<double>::quiet_NaN();
    }
  } // namespace

  double Result::error(const std::string &name) const
  {
    return number_in(summary.value("errors", nlohmann::json::object()), name);
  }
  double Result::number(const std::string &name) const
  {
    return number_in(summary, name);
  }
  double Result::counter(const std::string &name) const
  {
    return number_in(summary.value("counters", nlohmann::json::object()), name);
  }
  double Result::dissipated(const std::string &name) const
  {
    return number_in(summary.value("dissipated", nlohmann::json::object()),
                     name);
  }

  std::string Result::description() const
  {
    std::string text = directory.filename().string() + ": exit code " +
                       std::to_string(outcome.exit_code) + "\n" + outcome.err;
    if (summary.is_object() && summary["failure"].is_string())
      text += summary["failure"].get<std::string>() + "\n";
    return text;
  }

  Result run(const Workspace &workspace, const std::string &name,
             const Launch &what)
  {
    Result result;
    result.directory = workspace.path() / name;
    std::vector<std::string> command;
    if (what.ranks > 1)
      command = {NSFD_MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n",
                 std::to_string(what.ranks)};
    command.insert(command.end(), {what.program, what.file.string(), "--quiet",
                                   "--output", result.directory.string()});
    if (!what.report)
      command.insert(command.end(), {"--set", "Output/report=false"});
    for (const std::string &assignment : what.set)
      command.insert(command.end(), {"--set", assignment});
    command.insert(command.end(), what.more.begin(), what.more.end());
    result.outcome = Process(command, workspace.path()).wait(what.seconds);

    if (fs::exists(result.directory / "history.csv")) {
      result.history_text = read_text(result.directory / "history.csv");
      result.history = History(result.history_text);
    }
    if (fs::exists(result.directory / "summary.json"))
      result.summary = nlohmann::json::parse(
          read_text(result.directory / "summary.json"), nullptr, false);
    return result;
  }

  Result good_run(const Workspace &workspace, const std::string &name,
                  const Launch &what)
  {
    const Result result = run(workspace, name, what);
    EXPECT_TRUE(result.completed()) << result.description();
    if (!result.completed())
      return result;
    const double energy = result.history.largest_energy();
    EXPECT_LE(
        result.number("ledger_defect_max") *
            (energy < what.energy_scale ? energy / what.energy_scale : 1.),
        1e-9)
        << name;
    const double tolerance = std::strtod(
        entry(result.directory / "parameters.prm", "tolerance").c_str(),
        nullptr);
    EXPECT_GT(tolerance, 0.) << name;
    EXPECT_LE(result.number("residual_max"), tolerance) << name;
    return result;
  }

  namespace
  {
    template <typename Number>
    void append(const char *bytes, const std::size_t n_bytes,
                std::vector<double> &values)
    {
      std::vector<Number> numbers(n_bytes / sizeof(Number));
      std::memcpy(numbers.data(), bytes, numbers.size() * sizeof(Number));
      values.insert(values.end(), numbers.begin(), numbers.end());
    }

    /** Numbers of a type of VTK. */
    void append(const std::string &type, const char *bytes,
                const std::size_t n_bytes, std::vector<double> &values)
    {
      if (type == "Float64")
        append<double>(bytes, n_bytes, values);
      else if (type == "Int32")
        append<std::int32_t>(bytes, n_bytes, values);
      else
        append<std::uint8_t>(bytes, n_bytes, values);
    }
  } // namespace

  std::vector<Snapshot> snapshots(const fs::path &directory,
                                  const std::string &base)
  {
    // fields_00012.vtu, with several ranks fields_00012.0003.vtu
    const std::regex pattern(base + "_([0-9]+)(\\.[0-9]+)?\\.vtu");
    std::map<int, std::vector<fs::path>> pieces;
    for (const auto &file : fs::directory_iterator(directory)) {
      const std::string name = file.path().filename().string();
      std::smatch match;
      if (std::regex_match(name, match, pattern))
        pieces[std::stoi(match[1])].push_back(file.path());
    }
    const std::regex array("<DataArray type=\"(Float64|Int32|UInt8)\" "
                           "Name=\"([^\"]+)\" "
                           "NumberOfComponents=\"([0-9]+)\" "
                           "format=\"appended\" offset=\"([0-9]+)\"");
    std::vector<Snapshot> result;
    for (const auto &[number, files] : pieces) {
      Snapshot snapshot;
      for (const fs::path &file : files) {
        const std::string text = read_text(file);
        const std::size_t data = text.find("<AppendedData");
        const std::string header = text.substr(0, data);
        const char *blocks = text.data() + text.find('_', data) + 1;
        for (std::sregex_iterator match(header.begin(), header.end(), array),
             end;
             match != end; ++match) {
          const char *block = blocks + std::stoul((*match)[4]);
          std::uint64_t n_bytes;
          std::memcpy(&n_bytes, block, sizeof(n_bytes));
          append((*match)[1], block + sizeof(n_bytes), n_bytes,
                 snapshot[(*match)[2]]);
        }
      }
      result.push_back(std::move(snapshot));
    }
    return result;
  }

  std::string entry(const fs::path &parameters, const std::string &name)
  {
    std::istringstream stream(read_text(parameters));
    const std::regex pattern("\\s*set " + name + "\\s*=\\s*([^#]*?)\\s*(#.*)?");
    std::string line;
    std::smatch match;
    while (std::getline(stream, line))
      if (std::regex_match(line, match, pattern))
        return match[1];
    return "";
  }
} // namespace end_to_end
