#pragma once

#include "nsfd/records/observable_record.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * The text of units.json: the unit of every column of history.csv, with the
   * reactions of the @p driven boundaries, of the tables of observables, and of
   * every number of summary.json that has one. "" is a pure number. In two
   * dimensions energies, forces and areas are per metre of depth.
   */
  std::string units_text(unsigned int dimension,
                         const std::vector<std::string> &driven,
                         const std::vector<ObservableRecord> &observables);
} // namespace nsfd
