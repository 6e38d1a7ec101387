#include "verdict.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace wall
{
  namespace
  {
    namespace fs = std::filesystem;

    std::string last_lines(const fs::path &file, const std::size_t most)
    {
      std::ifstream stream(file);
      std::string all((std::istreambuf_iterator<char>(stream)), {});
      std::size_t begin = all.find("error");
      if (begin == std::string::npos)
        begin = all.size() > most ? all.size() - most : 0;
      std::string text = all.substr(begin, most);
      for (char &c : text)
        if (c == '\n')
          c = ' ';
      return text;
    }

    /** Rows of a file as numbers, columns by name. */
    struct Table {
      std::map<std::string, std::size_t> column;
      std::vector<std::vector<double>> rows;

      explicit Table(const fs::path &file)
      {
        std::ifstream stream(file);
        std::string line, word;
        if (std::getline(stream, line)) {
          std::istringstream words(line);
          while (std::getline(words, word, ','))
            column.emplace(word, column.size());
        }
        while (std::getline(stream, line)) {
          std::istringstream words(line);
          rows.emplace_back();
          while (std::getline(words, word, ','))
            rows.back().push_back(std::strtod(word.c_str(), nullptr));
          if (rows.back().size() < column.size())
            rows.pop_back();
        }
      }
      double operator()(const std::size_t row, const std::string &name) const
      {
        const auto found = column.find(name);
        return found == column.end() ? 0. : rows[row][found->second];
      }
    };

    /** Change of the momentum of all fragments over what moved at most. */
    double lost_momentum(const fs::path &output)
    {
      const Table fragments(output / "fragments.csv"),
          history(output / "history.csv");
      if (fragments.rows.empty() || history.rows.empty())
        return 0.;
      std::map<double, std::vector<double>> momentum; // of every step
      double mass = 0., kinetic = 0.;
      const char *const names[] = {"vx", "vy", "vz"};
      for (std::size_t i = 0; i < fragments.rows.size(); ++i) {
        std::vector<double> &p = momentum[fragments(i, "step")];
        p.resize(3, 0.);
        for (int d = 0; d < 3; ++d)
          p[d] += fragments(i, "mass") * fragments(i, names[d]);
        if (fragments(i, "step") == 0.)
          mass += fragments(i, "mass");
      }
      for (std::size_t i = 0; i < history.rows.size(); ++i)
        kinetic = std::max(kinetic, history(i, "kinetic"));
      if (momentum.size() < 2 || !(kinetic > 0.))
        return 0.;
      double change = 0.;
      for (int d = 0; d < 3; ++d)
        change = std::max(change, std::abs(momentum.rbegin()->second[d] -
                                           momentum.begin()->second[d]));
      return change / std::sqrt(2. * mass * kinetic);
    }
  } // namespace

  Verdict judge(const fs::path &output, const fs::path &log, const Ended &ended,
                const bool keeps_momentum, const double end)
  {
    Verdict verdict;
    nlohmann::json summary;
    if (std::ifstream stream(output / "summary.json"); stream)
      summary = nlohmann::json::parse(stream, nullptr, false);
    const bool readable = summary.is_object();
    const auto fail = [&verdict](const double by, const std::string &message) {
      verdict.through = false;
      verdict.worst = std::max(verdict.worst, by);
      verdict.message += (verdict.message.empty() ? "" : "; ") + message;
    };
    const double reached =
        readable ? summary.value("final_time", 0.) / end : 0.;
    if (ended.exit_code == 1) {
      verdict.refused = true;
      fail(0., "refused: " + last_lines(log, 300));
      return verdict;
    }
    if (ended.exit_code == 4 || ended.exit_code == 128 + 9 ||
        ended.exit_code == 128 + 24)
      fail(1e3 * (1. - reached) + 1.,
           fmt::format("{:.1f} s of CPU were not enough, {:.0f} % of the time, "
                       "{} steps, {:.0f} rejected",
                       ended.cpu_seconds, 100. * reached,
                       readable ? summary.value("steps", 0) : 0,
                       readable && summary.contains("counters")
                           ? summary["counters"].value("rejected_steps", 0.)
                           : 0.));
    else if (ended.exit_code == 3)
      fail(1e6 * (1. - reached) + 1.,
           fmt::format("not solved at {:.0f} % of the time: {}", 100. * reached,
                       readable && summary["failure"].is_string()
                           ? summary["failure"].get<std::string>()
                           : last_lines(log, 300)));
    else if (ended.exit_code != 0)
      fail(1e9, fmt::format("exit code {}: {}", ended.exit_code,
                            last_lines(log, 300)));
    if (!readable || !summary.contains("certificate"))
      return verdict;

    for (const auto &[name, line] : summary["certificate"]["lines"].items()) {
      const bool given = name.rfind("given by", 0) == 0;
      if (!given && name != "balance residual" && name != "penetration")
        continue;
      // what the bulk of explicit steps may give, whatever a run calls good
      constexpr double of_large_motion = 1e-3;
      const bool is_bulk = name == "given by large motion";
      const double value = line.value("value", 0.),
                   bound = is_bulk ? of_large_motion : line.value("bound", 0.);
      if (is_bulk ? value <= bound : line.value("verdict", "") != "not ok")
        continue;
      fail(bound > 0. ? value / bound : 1e3,
           fmt::format("{} {:.2g}, at most {:.2g}", name, value, bound));
    }
    if (keeps_momentum)
      if (const double lost = lost_momentum(output); lost > 1e-9)
        fail(lost / 1e-9, fmt::format("momentum changed by {:.1e}", lost));
    verdict.silent = !verdict.through && ended.exit_code == 0 &&
                     summary["certificate"].value("ok", false);
    return verdict;
  }
} // namespace wall
