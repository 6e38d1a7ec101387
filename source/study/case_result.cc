#include "case_result.h"

#include "core/cost.h"
#include "core/output_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Json = nlohmann::ordered_json;

    Json read_json(const std::string &file)
    {
      std::ifstream stream(file);
      return stream ? Json::parse(stream, nullptr, false) : Json();
    }

    /** NaN where a file has null. */
    double number(const Json &json, const char *name)
    {
      const auto found = json.find(name);
      if (found == json.end())
        return 0.;
      return found->is_number() ? found->get<double>()
                                : std::numeric_limits<double>::quiet_NaN();
    }

    double sum(const Json &object)
    {
      double total = 0.;
      for (const auto &value : object)
        if (value.is_number())
          total += value.get<double>();
      return total;
    }

    /**
     * CPU seconds of a run: the stages of its steps, and its set-up. (The
     * account `cost` shares out the time of the whole process, which is too
     * coarse for short runs on a busy machine.)
     */
    void add_times(const Json &summary, CaseResult &result)
    {
      const Json stages = summary.value("timings", Json::object());
      const double setup = number(stages, "set-up");
      result.setup.push_back(setup);
      result.solve.push_back(sum(stages) - setup - number(stages, "output"));
      result.wall.push_back(number(summary, "wall_seconds"));
    }

    void add_messages(const Json &cost, const double steps, CaseResult &result)
    {
      const Json sent = cost.value("messages", Json::object());
      result.messages = number(sent, "messages") / steps;
      result.message_bytes = number(sent, "message_bytes") / steps;
      result.collectives = number(sent, "collectives") / steps;
      result.copy_gain = number(sent, "copy_gain");
      result.product_gain = number(sent, "product_gain");
      double all = 0., waiting = 0.;
      const Json parts = cost.value("parts", Json::object());
      for (const auto &[name, part] : parts.items()) {
        all += number(part, "seconds");
        if (name == cost_name(Cost::messages))
          waiting = number(part, "seconds");
      }
      result.waiting = all > 0. ? waiting / all : 0.;
    }

    void fill(const Json &summary, CaseResult &result)
    {
      const double steps = std::max(1., number(summary, "steps"));
      result.steps = number(summary, "steps");
      result.dofs = number(summary, "dofs");
      result.cells = number(summary, "cells");
      const Json counters = summary.value("counters", Json::object());
      result.newton = number(counters, "newton") / steps;
      result.krylov = number(counters, "krylov") / steps;
      result.applications = number(counters, "operator_applications") / steps;
      result.block_factorisations = number(counters, "block_factorisations");
      result.global_factorisations = number(counters, "global_factorisations");
      result.balance_residual = number(summary, "ledger_defect_max");
      result.residual = number(summary, "residual_max");
      const Json dissipated = summary.value("dissipated", Json::object());
      const double energy =
          sum(summary.value("energy", Json::object())) + sum(dissipated);
      const double numerical = number(dissipated, "numerical");
      result.numerical_dissipation = energy > 0. ? numerical / energy : 0.;
      add_messages(summary.value("cost", Json::object()), steps, result);
      result.errors.clear();
      const Json errors = summary.value("errors", Json::object());
      for (const auto &[name, value] : errors.items())
        result.errors[name] = value.is_number()
                                  ? value.get<double>()
                                  : std::numeric_limits<double>::quiet_NaN();
    }

    bool same(const std::map<std::string, double> &a,
              const std::map<std::string, double> &b)
    {
      return a.size() == b.size() &&
             std::equal(a.begin(), a.end(), b.begin(),
                        [](const auto &x, const auto &y) {
                          return x.first == y.first && (x.second == y.second ||
                                                        (std::isnan(x.second) &&
                                                         std::isnan(y.second)));
                        });
    }
  } // namespace

  double median(std::vector<double> values)
  {
    if (values.empty())
      return 0.;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return 0.5 * (values[n / 2] + values[(n - 1) / 2]);
  }

  bool is_done(const CaseResult &result)
  {
    return result.status == CaseResult::Status::done;
  }

  double setup_median(const CaseResult &result) { return median(result.setup); }
  double solve_median(const CaseResult &result) { return median(result.solve); }

  double solve_spread(const CaseResult &result)
  {
    const auto &solve = result.solve;
    if (solve.size() < 2 || median(solve) <= 0.)
      return 0.;
    const auto [low, high] = std::minmax_element(solve.begin(), solve.end());
    return (*high - *low) / median(solve);
  }

  const char *name_of(const CaseResult::Status status)
  {
    switch (status) {
    case CaseResult::Status::done:
      return "done";
    case CaseResult::Status::failed:
      return "failed";
    case CaseResult::Status::bad_input:
      return "bad input";
    case CaseResult::Status::broken:
      return "broken";
    case CaseResult::Status::stopped:
      return "stopped";
    default:
      return "not run";
    }
  }

  bool add_summary(const std::string &file, CaseResult &result)
  {
    const Json summary = read_json(file);
    if (!summary.is_object() || !summary.contains("timings"))
      return false;
    const std::map<std::string, double> before = result.errors;
    const bool first = result.solve.empty();
    add_times(summary, result);
    fill(summary, result);
    const double memory = number(summary, "peak_memory_mb");
    const double n = double(result.solve.size());
    // the mean over the repeats, which hardly differ
    result.peak_memory_mb += (memory - result.peak_memory_mb) / n;
    result.reproducible =
        result.reproducible && (first || same(before, result.errors));
    const auto failure = summary.find("failure");
    if (failure != summary.end() && failure->is_string())
      result.failure = failure->get<std::string>();
    return true;
  }

  void write_case(const std::string &file, const CaseStamp &stamp,
                  const CaseResult &r)
  {
    Json json;
    json["status"] = name_of(r.status);
    json["failure"] = r.failure;
    json["exit_code"] = r.exit_code;
    json["version"] = stamp.version;
    json["git_hash"] = stamp.git_hash;
    json["ranks"] = stamp.ranks;
    json["plug_ins"] = stamp.plug_ins;
    json["setup_seconds"] = r.setup;
    json["solve_seconds"] = r.solve;
    json["wall_seconds"] = r.wall;
    json["peak_memory_mb"] = r.peak_memory_mb;
    json["reproducible"] = r.reproducible;
    write_file_atomically(file, json.dump(2) + "\n");
  }

  bool read_case(const std::string &file, const CaseStamp &stamp,
                 const unsigned int repeats, CaseResult &result)
  {
    const Json json = read_json(file);
    if (!json.is_object() || json.value("status", "") != "done" ||
        json.value("version", "") != stamp.version ||
        json.value("git_hash", "") != stamp.git_hash ||
        json.value("ranks", 0u) != stamp.ranks ||
        json.value("plug_ins", "") != stamp.plug_ins)
      return false;
    const auto times = [&json](const char *name) {
      return json.value(name, std::vector<double>());
    };
    if (times("solve_seconds").size() < repeats)
      return false;
    CaseResult found;
    const std::string summary =
        file.substr(0, file.size() - std::string("case.json").size()) +
        "summary.json";
    if (!add_summary(summary, found))
      return false;
    found.status = CaseResult::Status::done;
    found.exit_code = 0;
    found.failure.clear();
    found.setup = times("setup_seconds");
    found.solve = times("solve_seconds");
    found.wall = times("wall_seconds");
    found.peak_memory_mb = json.value("peak_memory_mb", 0.);
    found.reproducible = json.value("reproducible", true);
    found.taken_over = true;
    result = found;
    return true;
  }
} // namespace nsfd
