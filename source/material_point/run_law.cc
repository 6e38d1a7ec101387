#include "run_law.h"

#include "curve_names.h"
#include "law_charts.h"
#include "law_table.h"
#include "run_bar.h"
#include "try_contract.h"

#include "core/exit_code.h"
#include "core/load_plug_in.h"
#include "core/output_folder.h"
#include "visualization/svg.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace nsfd
{
  namespace
  {
    std::string csv(const Curve &curve)
    {
      std::string text =
          "path,opening,slip,beta,cohesive_normal,cohesive_tangential,contact,"
          "friction,stored,damage,friction_work,work\n";
      for (const CurveRow &row : curve)
        text +=
            fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", row.path,
                        row.opening, row.slip, row.beta, row.cohesive_normal,
                        row.cohesive_tangential, row.contact, row.friction,
                        row.stored, row.damage, row.friction_work, row.work);
      return text;
    }

    double largest_traction(const Curve &curve)
    {
      double largest = 0.;
      for (const CurveRow &row : curve)
        largest = std::max(
            largest, std::hypot(std::max(row.normal(), 0.), row.tangential()));
      return largest;
    }

    nlohmann::json summary(const LawInput &input,
                           const std::vector<Curve> &curves)
    {
      nlohmann::json result = {{"completed", true},
                               {"path", input.path_name},
                               {"curves", nlohmann::json::array()}};
      for (std::size_t i = 0; i < curves.size(); ++i) {
        const CohesiveLaw &law = *input.curves[i].interaction.law;
        const CurveRow &end = curves[i].back();
        result["curves"].push_back({
            {"name", input.curves[i].name},
            {"law", input.curves[i].law_name},
            {"file", curve_file(input, i)},
            {"strength", law.strength()},
            {"toughness", law.toughness()},
            {"peak_opening", law.peak_opening()},
            {"final_opening", law.final_opening()},
            {"steepest_softening", law.steepest_softening()},
            {"largest_traction", largest_traction(curves[i])},
            {"beta", end.beta},
            {"stored", end.stored},
            {"damage", end.damage},
            {"friction_work", end.friction_work},
            {"numerical", end.numerical()},
            {"work", end.work},
        });
      }
      return result;
    }

    void write_files(const LawInput &input, const std::vector<Curve> &curves)
    {
      const std::string folder = input.directory + "/";
      write_file_atomically(folder + "parameters.prm", input.echo);
      for (std::size_t i = 0; i < curves.size(); ++i)
        write_file_atomically(folder + curve_file(input, i), csv(curves[i]));
      write_file_atomically(folder + "law.svg", traction_chart(input, curves));
      write_file_atomically(folder + "energies.svg",
                            energy_chart(input, curves));
      write_file_atomically(folder + "summary.json",
                            summary(input, curves).dump(2) + "\n");
    }

    void print_table(const LawInput &input, const std::vector<Curve> &curves)
    {
      for (std::size_t i = 0; i < curves.size(); ++i) {
        const LawCurveInput &curve = input.curves[i];
        const CohesiveLaw &law = *curve.interaction.law;
        const CurveRow &end = curves[i].back();
        const double G = law.toughness();
        std::cout << curve.name
                  << (curve.name == curve.law_name ? "" : ": " + curve.law_name)
                  << "\n";
        const auto line = table_line;
        line("strength",
             fmt::format("{}  at {}", engineering(law.strength(), "Pa"),
                         engineering(law.peak_opening(), "m")));
        line("toughness G", engineering(G, "J/m²", 4));
        line("final opening", engineering(law.final_opening(), "m"));
        line("steepest softening",
             engineering(law.steepest_softening(), "Pa/m"));
        line("largest traction",
             engineering(largest_traction(curves[i]), "Pa"));
        line("energy removed", share_of(end.damage, G));
        line("still stored", share_of(end.stored, G));
        if (curve.interaction.friction > 0.)
          line("friction", share_of(end.friction_work, G));
        if (input.cohesion_rule != CohesionRule::exact)
          line("lost by the rule", share_of(end.numerical(), G));
      }
    }
  } // namespace

  int run_law(const LawCommand &command)
  {
    if (command.contract)
      return try_contract(command);
    InputErrors errors;
    const auto input = read_law(command.file, command.overrides, errors);
    std::cerr << errors.report();
    if (!input)
      return exit_code::bad_input;
    if (command.check) {
      if (!command.quiet)
        std::cout << "nothing is wrong, nothing is run\n";
      return exit_code::done;
    }
    if (!claim_directory(input->directory, command.force))
      return exit_code::bad_input;
    OutputFolder &folder = OutputFolder::instance();
    folder.describe(nlohmann::json{{"subcommand", "law"},
                                   {"file", command.file},
                                   {"plug_ins", used_plug_ins()}}
                        .dump());

    if (input->bar) {
      run_bar(*input, command.quiet);
      folder.finish();
      return exit_code::done;
    }
    std::vector<Curve> curves;
    for (const LawCurveInput &curve : input->curves)
      curves.push_back(
          drive_point(curve.interaction, curve.points, input->cohesion_rule));
    write_files(*input, curves);
    folder.finish();
    if (command.quiet)
      return exit_code::done;
    if (!input->entries.empty())
      std::cout << "with " << input->entries << "\n";
    std::cout << "path: " << input->path_name << "\n";
    print_table(*input, curves);
    std::cout << "in " << input->directory << ": ";
    for (std::size_t i = 0; i < curves.size(); ++i)
      std::cout << curve_file(*input, i) << ", ";
    std::cout << "law.svg, energies.svg\n";
    return exit_code::done;
  }
} // namespace nsfd
