#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

/** Runs the built program as a user does and reads the files it writes. */
namespace end_to_end
{
  /** A file of prm/verification, by its name without `.prm`. */
  std::filesystem::path scene(const std::string &name);
  /** One of prm/benchmarks. */
  std::filesystem::path benchmark(const std::string &name);
  /** The entry that takes a file of prm/meshes. */
  std::string with_mesh(const std::string &file);
  /** Breaks, closes and rubs: springs, implicit steps. */
  std::filesystem::path torn_plate();
  /** All shipped scenes. */
  std::filesystem::path prm_folder();

  std::string read_text(const std::filesystem::path &file);
  void write_text(const std::filesystem::path &file, const std::string &text);
  /** Names of all files and directories below, sorted. */
  std::vector<std::string> files_below(const std::filesystem::path &directory);

  /** A directory for one test: empty at its start, gone if it succeeded. */
  class Workspace
  {
  public:
    Workspace();
    ~Workspace();
    Workspace(const Workspace &) = delete;
    Workspace &operator=(const Workspace &) = delete;

    const std::filesystem::path &path() const { return path_; }

  private:
    std::filesystem::path path_;
  };

  struct Outcome {
    int exit_code = -1; ///< 128 + signal if one ended it
    std::string out, err;
  };

  enum class Environment {
    prepared, ///< root and more ranks than cores allowed, no daemon if serial
    bare      ///< nothing set for MPI, as in a fresh terminal
  };

  /** A process of its own group; ended with the object. */
  class Process
  {
  public:
    Process(const std::vector<std::string> &command,
            const std::filesystem::path &directory,
            Environment environment = Environment::prepared);
    ~Process();
    Process(const Process &) = delete;
    Process &operator=(const Process &) = delete;

    bool is_running();
    void send(int signal) const;
    /** Ends the process, with exit code -1, if it takes longer. */
    Outcome wait(double seconds);

  private:
    int pid_ = -1, status_ = 0;
    bool ended_ = false;
    std::filesystem::path out_, err_;
  };

  /** `nsfd ARGUMENTS` in the directory of the test. */
  Outcome nsfd(const Workspace &workspace,
               const std::vector<std::string> &arguments,
               Environment environment = Environment::prepared);

  /** history.csv, a column per name. */
  class History
  {
  public:
    History() = default;
    explicit History(const std::string &text);

    const std::vector<double> &operator[](const std::string &name) const;
    const std::vector<std::string> &names() const { return names_; }
    std::size_t size() const
    {
      return columns_.empty() ? 0 : columns_[0].size();
    }
    /** The largest energy line of the run, any sign. */
    double largest_energy() const;

    static const std::vector<std::string> &energy_lines();

  private:
    std::vector<std::string> names_;
    std::vector<std::vector<double>> columns_;
  };

  struct Launch {
    std::filesystem::path file;
    std::vector<std::string> set = {}; ///< 'Section/name=value'
    unsigned int ranks = 1;
    bool report = false; ///< pictures take longer than most scenes
    double seconds = 120.;
    /// J, for the energy balance of a scene in which hardly anything moves
    double energy_scale = 0.;
    std::vector<std::string> more = {}; ///< further words, --plug-in FILE
    std::string program = NSFD_PROGRAM; ///< or one that is installed
  };

  struct Result {
    Outcome outcome;
    std::filesystem::path directory;
    std::string history_text;
    History history;
    nlohmann::json summary;

    bool completed() const
    {
      return outcome.exit_code == 0 && summary.value("completed", false);
    }
    double error(const std::string &name) const;
    double number(const std::string &name) const;
    double counter(const std::string &name) const;
    double dissipated(const std::string &name) const;
    /** What to print when something went wrong. */
    std::string description() const;
  };

  Result run(const Workspace &workspace, const std::string &name,
             const Launch &what);

  /**
   * The same, and what holds for every good run: exit code 0, completed, the
   * energy balance closed to 1e-9, no step above its tolerance. Failures are
   * added to the current test.
   */
  Result good_run(const Workspace &workspace, const std::string &name,
                  const Launch &what);

  /** All pieces of fields_00003.vtu or interfaces_00003.vtu, arrays by name. */
  using Snapshot = std::map<std::string, std::vector<double>>;
  std::vector<Snapshot> snapshots(const std::filesystem::path &directory,
                                  const std::string &base);

  /** Values of an entry in parameters.prm, without its comment. */
  std::string entry(const std::filesystem::path &parameters,
                    const std::string &name);
} // namespace end_to_end
