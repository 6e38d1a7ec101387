#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  class Archive;

  /** What a process counts from zero and a resumed run goes on with. */
  struct RunTotals {
    std::map<std::string, double> counters;
    std::vector<std::pair<std::string, double>> timings; ///< s of CPU
    double wall_seconds = 0., cpu_seconds = 0.;
  };

  /** What a run had counted before its last checkpoint. */
  class EarlierTotals
  {
  public:
    void add_to(RunTotals &totals) const;

    /** @p present: as this process has counted so far. */
    void serialize(Archive &archive, const RunTotals &present);

  private:
    RunTotals earlier_;
  };
} // namespace nsfd
