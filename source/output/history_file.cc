#include "nsfd/output/history_file.h"

#include <fmt/format.h>

#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** A column name as CSV wants it: quoted only where it must be. */
    std::string csv_name(const std::string &name)
    {
      if (name.find_first_of(",\"\r\n") == std::string::npos)
        return name;
      std::string quoted = "\"";
      for (const char c : name)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
      return quoted + '"';
    }
  } // namespace

  std::string HistoryFile::header(const std::vector<std::string> &driven,
                                  const unsigned int dimension)
  {
    std::string line =
        "step,time,time_step,kinetic,elastic,cohesive,damage,friction,viscous,"
        "plastic,impact,numerical,work,ledger_defect,broken_area,fragments,"
        "active,newton,krylov,residual";
    for (const auto &name : driven)
      for (unsigned int d = 0; d < dimension; ++d)
        line += ',' + csv_name("reaction_" + name + '_' + "xyz"[d]);
    return line;
  }

  HistoryFile::HistoryFile(const std::string &path,
                           const std::vector<std::string> &driven,
                           const unsigned int dimension)
      : path_(path), n_reactions_(driven.size() * dimension), file_(path)
  {
    write_line(header(driven, dimension));
  }

  void HistoryFile::write(const HistoryRow &row)
  {
    if (row.reactions.size() != n_reactions_)
      throw std::logic_error(
          fmt::format("A row of '{}' has {} reaction columns, not {}.", path_,
                      n_reactions_, row.reactions.size()));

    const EnergyLines &e = row.energy;
    std::string line = fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", row.step,
        row.time, row.time_step, e.kinetic, e.elastic, e.cohesive, e.damage,
        e.friction, e.viscous, e.plastic, e.impact, e.numerical, e.work,
        row.ledger_defect, row.broken_area, row.fragments, row.active,
        row.newton, row.krylov, row.residual);
    for (const double reaction : row.reactions)
      line += fmt::format(",{}", reaction);
    write_line(line);
  }

  void HistoryFile::write_line(const std::string &line)
  {
    file_ << line << '\n' << std::flush;
    if (!file_)
      throw std::runtime_error("Cannot write '" + path_ + "'.");
  }
} // namespace nsfd
