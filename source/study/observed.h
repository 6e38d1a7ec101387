#pragma once

#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * What a study observes of its runs: "fragments", "dissipated/damage" (a key
   * of summary.json), "max reaction_top_y" (a column of history.csv), "min
   * tip/speed", "final tip/length" (a column of observables/tip.csv).
   */
  struct ObservedQuantity {
    enum class Kind { summary, largest, smallest, last, span };

    Kind kind = Kind::summary;
    std::string table;  ///< file in the folder of a run; of columns
    std::string column; ///< or path in summary.json
    std::string name;   ///< "max_reaction_top_y"
  };

  /** Empty, with a @p problem, if the text is none. */
  std::vector<ObservedQuantity> parse_observed(const std::string &text,
                                               std::string &problem);

  /**
   * Adds what the files of a run say of the quantities, by name; those that it
   * does not have are left out. Values that are not finite do not count.
   */
  void observe(const std::vector<ObservedQuantity> &quantities,
               const std::string &folder,
               std::map<std::string, double> &values);
} // namespace nsfd
