#pragma once

#include "history_file.h"

#include "nsfd/records/observable_record.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * The text of units.json: the unit of every column of history.csv, which are
   * @p columns, of the tables of observables, and of every number of
   * summary.json that has one. "" is a pure number. In two dimensions energies,
   * forces and areas are per metre of depth, in axisymmetric scenes per radian.
   */
  std::string units_text(const HistoryFile::Columns &columns,
                         const std::vector<ObservableRecord> &observables);
} // namespace nsfd
