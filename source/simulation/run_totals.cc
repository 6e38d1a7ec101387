#include "run_totals.h"

#include "nsfd/core/archive.h"

#include <algorithm>
#include <sstream>

namespace nsfd
{
  namespace
  {
    /** Pairs of a name and a number. */
    template <typename Pairs>
    void pass(Archive &archive, const std::string &what, Pairs &pairs)
    {
      std::string names;
      std::vector<double> values;
      for (const auto &[name, value] : pairs) {
        names += name + '\n';
        values.push_back(value);
      }
      archive.on_root(what + "_names", names);
      archive.on_root(what, values);
      if (!archive.reads())
        return;
      pairs = Pairs();
      std::istringstream lines(names);
      std::string name;
      for (std::size_t k = 0; k < values.size() && std::getline(lines, name);
           ++k)
        pairs.insert(pairs.end(), {name, values[k]});
    }

    double &entry(std::vector<std::pair<std::string, double>> &timings,
                  const std::string &name)
    {
      auto found = std::find_if(timings.begin(), timings.end(),
                                [&](const auto &t) { return t.first == name; });
      if (found == timings.end())
        found = timings.insert(timings.end(), {name, 0.});
      return found->second;
    }
  } // namespace

  void EarlierTotals::add_to(RunTotals &totals) const
  {
    for (const auto &[name, value] : earlier_.counters)
      if (value != 0.)
        totals.counters[name] += value;
    for (const auto &[name, value] : earlier_.timings)
      entry(totals.timings, name) += value;
    totals.wall_seconds += earlier_.wall_seconds;
    totals.cpu_seconds += earlier_.cpu_seconds;
  }

  void EarlierTotals::serialize(Archive &archive, const RunTotals &present)
  {
    const Archive::Part part(archive, "totals");
    RunTotals stored = present;
    add_to(stored);
    pass(archive, "counters", stored.counters);
    pass(archive, "timings", stored.timings);
    archive.numbers("seconds", stored.wall_seconds, stored.cpu_seconds);
    if (!archive.reads())
      return;
    // what does not grow, or has been read by its owner, is there already
    earlier_ = stored;
    for (const auto &[name, value] : present.counters)
      earlier_.counters[name] -= value;
  }
} // namespace nsfd
