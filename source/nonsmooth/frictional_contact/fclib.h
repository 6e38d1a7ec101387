#pragma once

#include "contact_problem.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  /** A file that holds no contact problem; the text says why. */
  class BadContactFile : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /**
   * A problem in the HDF5 layout of FCLIB (Acary, Bremond, Huber: "On solving
   * contact problems with Coulomb friction", 2018, and the library's sources):
   * group `fclib_local` with `spacedim`, matrix `W`, `vectors/q` and `mu`;
   * `solution/r` and the first of `guesses` if they are there. W may be stored
   * by rows (nz = -2), by columns (-1) or as triplets (nz >= 0). Writers
   * disagree on which index of a triplet is the row: that order is taken under
   * which the stored solution is one; without a solution `i` is the row.
   *
   * @throws BadContactFile for anything else
   */
  ContactProblem read_fclib(const std::string &file);

  /** A problem, or why a file holds none. */
  struct ReadProblem {
    ContactProblem problem;
    std::string error;
  };

  /** Many files at once, each with the outcome of reading it alone, but as
   * long as they are sound at a tenth of the price: a file is read in a copy of
   * the process, and sound ones share it. */
  std::vector<ReadProblem> read_fclib(const std::vector<std::string> &files);

  /**
   * The same layout, W by rows, with guess and solution if the problem has
   * them. Overwrites the file.
   *
   * @throws BadContactFile if it cannot be written
   */
  void write_fclib(const std::string &file, const ContactProblem &problem);
} // namespace nsfd
