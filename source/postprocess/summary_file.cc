#include "summary_file.h"

#include "core/output_folder.h"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace nsfd
{
  namespace
  {
    using Json = nlohmann::ordered_json;

    Json number(const double value)
    {
      return std::isfinite(value) ? Json(value) : Json(nullptr);
    }

    template <typename Pairs>
    Json numbers(const Pairs &pairs)
    {
      Json object = Json::object();
      for (const auto &[name, value] : pairs)
        object[name] = number(value);
      return object;
    }

    Json costs(const CostRecord &cost)
    {
      Json json = Json::object();
      json["parts"] = Json::object();
      for (const auto &part : cost.parts)
        json["parts"][part.name] = {{"seconds", number(part.seconds)},
                                    {"calls", part.calls}};
      json["per_step"] = Json::object();
      for (const auto &spread : cost.per_step)
        json["per_step"][spread.name] = {{"median", number(spread.median)},
                                         {"worst", number(spread.worst)}};
      json["memory_bytes"] = numbers(cost.memory);
      Json loop = {{"applications", number(cost.applications)},
                   {"seconds", number(cost.seconds)},
                   {"flops", number(cost.flops)},
                   {"bytes", number(cost.bytes)}};
      if (cost.has_limits()) {
        loop["copy_bytes_per_second"] = number(cost.copy_bytes_per_second);
        loop["product_flops_per_second"] =
            number(cost.product_flops_per_second);
        loop["share_of_limit"] = number(cost.share_of_limit());
        loop["limit"] = cost.limited_by_copy() ? "copy" : "product";
      }
      json["application_of_W"] = loop;
      if (cost.ranks > 1) {
        json["messages"] = {
            {"ranks", cost.ranks},
            {"messages", number(cost.sent.messages)},
            {"message_bytes", number(cost.sent.message_bytes)},
            {"collectives", number(cost.sent.collectives)},
            {"collective_bytes", number(cost.sent.collective_bytes)}};
        if (cost.copy_gain > 0.) {
          json["messages"]["copy_gain"] = number(cost.copy_gain);
          json["messages"]["product_gain"] = number(cost.product_gain);
        }
      }
      return json;
    }

    Json optional_number(const std::optional<double> &value)
    {
      return value ? number(*value) : Json(nullptr);
    }

    Json judged(const Certificate &certificate)
    {
      Json json = Json::object();
      json["ok"] = certificate.is_ok();
      json["verdict"] = certificate.verdict();
      for (const CertificateLine &line : certificate.lines) {
        Json entry = Json::object();
        entry["verdict"] = text_of(line.verdict);
        if (line.number)
          entry["value"] = number(*line.number);
        if (line.limit)
          entry["bound"] = number(*line.limit);
        if (!line.remark.empty())
          entry["remark"] = line.remark;
        json["lines"][line.name] = entry;
      }
      return json;
    }

    /** Of the time loop, without output. */
    double loop_seconds(const Summary &summary)
    {
      double seconds = summary.cpu_seconds;
      for (const auto &[stage, spent] : summary.timings)
        if (stage == "set-up" || stage == "output")
          seconds -= spent;
      return std::max(0., seconds);
    }

    Json sizes(const FragmentSizes &all)
    {
      return {{"mean_size", number(all.mean_size)},
              {"median_size", number(all.median_size)},
              {"smallest_size", number(all.sizes.back())},
              {"largest_size", number(all.sizes.front())},
              {"mean_size_by_mass", number(all.mean_size_by_mass)},
              {"total_mass", number(all.total_mass)},
              {"mean_mass", number(all.mean_mass)},
              {"median_mass", number(all.median_mass)},
              {"smallest_mass", number(all.smallest_mass)},
              {"largest_mass", number(all.largest_mass)},
              {"largest_mass_share", number(all.largest_mass / all.total_mass)},
              {"mass_exponent", optional_number(all.mass_exponent)},
              {"surface", number(all.surface)},
              {"histogram", {{"edges", all.edges}, {"numbers", all.numbers}}}};
    }

    Json observed(const std::vector<ObservableRecord> &records)
    {
      Json json = Json::object();
      for (const auto &record : records) {
        Json last = Json::object(), peak = Json::object();
        for (std::size_t k = 0; k < record.last.size(); ++k)
          last[record.columns[k].name] = number(record.last[k]);
        for (std::size_t k = 0; k < record.peak.size(); ++k)
          peak[record.columns[k].name] = {
              {"value", number(record.peak[k])},
              {"time", number(record.peak_time[k])}};
        json[record.name] = {
            {"type", record.type}, {"last", last}, {"peak", peak}};
      }
      return json;
    }

    void write_json(const std::string &path, const Json &json)
    {
      // host names and paths may hold bytes that are no UTF-8
      write_file_atomically(
          path,
          json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
    }
  } // namespace

  void write_summary(const std::string &path, const Summary &summary,
                     const RunFindings &findings)
  {
    const EnergyLines &e = summary.energy;

    Json json;
    json["completed"] = summary.completed;
    json["failure"] =
        summary.failure.empty() ? Json(nullptr) : Json(summary.failure);
    json["dimension"] = summary.dimension;
    if (summary.axisymmetric)
      json["axisymmetric"] = true;
    json["steps"] = summary.steps;
    json["dofs"] = summary.dofs;
    json["cells"] = summary.cells;
    json["interface_points"] = summary.interface_points;
    json["final_time"] = number(summary.final_time);
    json["wall_seconds"] = number(summary.wall_seconds);
    json["cpu_seconds"] = number(summary.cpu_seconds);
    json["setup_seconds"] = number(summary.setup_seconds);
    json["loop_cpu_seconds"] = number(loop_seconds(summary));
    json["peak_memory_mb"] = number(summary.peak_memory_mb);
    json["energy"] = {{"kinetic", number(e.kinetic)},
                      {"elastic", number(e.elastic)},
                      {"cohesive", number(e.cohesive)}};
    json["dissipated"] = {
        {"damage", number(e.damage)},    {"friction", number(e.friction)},
        {"viscous", number(e.viscous)},  {"plastic", number(e.plastic)},
        {"impact", number(e.impact)},    {"numerical", number(e.numerical)},
        {"absorbed", number(e.absorbed)}};
    json["work"] = number(e.work);
    if (summary.pressure_work)
      json["crack_pressure_work"] = number(*summary.pressure_work);
    if (summary.heat)
      json["heat"] = {{"made", number(summary.heat->made)},
                      {"given", number(summary.heat->given)},
                      {"stored", number(summary.heat->stored)},
                      {"hottest", number(summary.heat->hottest)}};
    if (summary.viscous_traction_max)
      json["viscous_traction_max"] = number(*summary.viscous_traction_max);
    json["ledger_defect_max"] = number(summary.balance_residual_max);
    json["residual_max"] = number(summary.residual_max);
    json["penetration_max"] = number(summary.penetration_max);
    json["penetration_bound"] = number(summary.penetration_bound);
    json["positive_friction_work"] = number(summary.positive_friction_work);
    json["rigid_drift_max"] = number(summary.rigid_drift_max);
    json["fragments"] = summary.fragments;
    if (findings.fragment_sizes)
      json["fragment_sizes"] = sizes(*findings.fragment_sizes);
    if (findings.certificate)
      json["certificate"] = judged(*findings.certificate);
    json["counters"] = numbers(summary.counters);
    json["errors"] = numbers(summary.errors);
    if (!summary.observables.empty())
      json["observables"] = observed(summary.observables);
    json["timings"] = numbers(summary.timings);
    json["cost"] = costs(summary.cost);
    write_json(path, json);
  }

  std::string describe_run(const RunInfo &info)
  {
    Json json;
    json["version"] = info.version;
    json["git_hash"] = info.git_hash;
    json["build_type"] = info.build_type;
    json["interface"] = info.interface;
    json["plug_ins"] = Json::array();
    for (const PlugIn &one : info.plug_ins)
      json["plug_ins"].push_back({{"name", one.name},
                                  {"file", one.file},
                                  {"checksum", one.checksum},
                                  {"parts", one.parts},
                                  {"used", one.used}});
    json["libraries"] = info.libraries;
    json["command_line"] = info.command_line;
    json["file"] = info.file;
    json["date"] = info.date;
    json["host"] = info.host;
    json["ranks"] = info.ranks;
    json["seeds"] = info.seeds;
    json["parts"] = Json::array();
    for (const auto &[kind, name] : info.parts)
      json["parts"].push_back({{"kind", kind}, {"name", name}});
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
  }
} // namespace nsfd
