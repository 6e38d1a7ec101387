#include "nsfd/output/history_file.h"

#include <fmt/format.h>

#include <sstream>
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
      : n_reactions_(driven.size() * dimension),
        file_(path, header(driven, dimension))
  {
  }

  void HistoryFile::write(const HistoryRow &row)
  {
    if (row.reactions.size() != n_reactions_)
      throw std::logic_error(
          fmt::format("A row of '{}' has {} reaction columns, not {}.",
                      file_.path(), n_reactions_, row.reactions.size()));

    const EnergyLines &e = row.energy;
    std::string line = fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", row.step,
        row.time, row.time_step, e.kinetic, e.elastic, e.cohesive, e.damage,
        e.friction, e.viscous, e.plastic, e.impact, e.numerical, e.work,
        row.ledger_defect, row.broken_area, row.fragments, row.active,
        row.newton, row.krylov, row.residual);
    for (const double reaction : row.reactions)
      line += fmt::format(",{}", reaction);
    file_.write(line);
  }

  HistoryFile::HistoryFile(const std::string &path,
                           const std::vector<std::string> &driven,
                           const unsigned int dimension,
                           const std::uintmax_t n_bytes)
      : n_reactions_(driven.size() * dimension), file_(path, n_bytes)
  {
  }

  std::vector<HistoryRow> HistoryFile::read(const std::string &path,
                                            const std::size_t n_reactions,
                                            const std::uintmax_t n_bytes)
  {
    constexpr std::size_t n_fixed = 20;
    const std::string text = read_rows(path, n_bytes);
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line); // the header
    std::vector<HistoryRow> rows;
    while (std::getline(lines, line)) {
      const auto x = numbers_of(line, n_fixed + n_reactions);
      if (x.empty() || text.back() != '\n')
        throw std::runtime_error(fmt::format(
            "'{}', line {}, is not what it was at the checkpoint", path,
            rows.size() + 2));
      HistoryRow &row = rows.emplace_back();
      row.step = unsigned(x[0]);
      row.time = x[1];
      row.time_step = x[2];
      row.energy = {x[3], x[4], x[5], x[6], x[7], x[8], x[9], x[10], x[11],
                    x[12]};
      row.ledger_defect = x[13];
      row.broken_area = x[14];
      row.fragments = unsigned(x[15]);
      row.active = unsigned(x[16]);
      row.newton = unsigned(x[17]);
      row.krylov = unsigned(x[18]);
      row.residual = x[19];
      row.reactions.assign(x.begin() + n_fixed, x.end());
    }
    return rows;
  }
} // namespace nsfd
