#pragma once

#include "nsfd/records/run_record.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** What a finished run has left in its folder. */
  struct RunFolder {
    std::string name; ///< as given

    // of summary.json
    bool completed = false;
    std::string failure;
    unsigned int dimension = 2;
    bool axisymmetric = false;
    /// all numbers as `energy/kinetic`, in the order of the file
    std::vector<std::pair<std::string, double>> numbers;
    /// of its certificate: name, verdict
    std::vector<std::pair<std::string, std::string>> certificate;

    /// columns of history.csv, name and one value per step
    std::vector<std::pair<std::string, std::vector<double>>> history;
    std::optional<std::string> parameters; ///< parameters.prm
    /// of fragments.csv, at its last time: sizes, falling
    std::vector<double> fragment_sizes;

    /** Nothing if there is no such number, NaN if the file has null. */
    std::optional<double> number(const std::string &path) const;
    const std::vector<double> *column(const std::string &name) const;
    /** The largest energy of its history and its summary, J. */
    double largest_energy() const;
  };

  /**
   * Reads a folder, which must hold summary.json, history.csv and
   * parameters.prm, or a summary.json with what is beside it.
   * @throws std::runtime_error which says what is missing or cannot be read
   */
  RunFolder read_run(const std::string &path);
} // namespace nsfd
