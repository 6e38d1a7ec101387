#include "try_contract.h"

#include "cohesive_laws/law_contract.h"
#include "core/exit_code.h"
#include "read_law.h"

#include <fmt/format.h>

#include <iostream>

namespace nsfd
{
  namespace
  {
    /** @return how many promises are broken */
    unsigned int print_promises(const LawCurveInput &curve,
                                const std::string &entries, const bool quiet)
    {
      unsigned int n_broken = 0;
      if (!quiet)
        std::cout << curve.name
                  << (curve.name == curve.law_name ? "" : ": " + curve.law_name)
                  << (entries.empty() ? "" : ": " + entries) << "\n";
      for (const auto &promise :
           law_contract::promises(*curve.interaction.law)) {
        const bool kept = promise.failure.empty();
        n_broken += !kept;
        if (!quiet || !kept)
          std::cout << fmt::format("  {:<8}{}\n", kept ? "kept" : "BROKEN",
                                   promise.text);
        if (!kept)
          std::cout << "          " << promise.failure << "\n";
      }
      return n_broken;
    }
  } // namespace

  int try_contract(const LawCommand &command)
  {
    InputErrors errors;
    const auto inputs = read_examples(command.file, command.overrides, errors);
    std::cerr << errors.report();
    if (errors.has_errors())
      return exit_code::bad_input;
    unsigned int n_broken = 0;
    for (const auto &input : inputs)
      for (const LawCurveInput &curve : input->curves)
        n_broken += print_promises(curve, input->entries, command.quiet);
    if (n_broken > 0)
      std::cerr << fmt::format("{} broken: solvers and the energy balance rest "
                               "on them, see include/nsfd/cohesive_laws/"
                               "cohesive_law.h\n",
                               n_broken);
    return n_broken > 0 ? exit_code::bad_input : exit_code::done;
  }
} // namespace nsfd
