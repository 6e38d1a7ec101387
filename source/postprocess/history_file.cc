#include "history_file.h"

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> fixed_columns = {
        "step",      "time",      "time_step", "kinetic",       "elastic",
        "cohesive",  "damage",    "friction",  "viscous",       "plastic",
        "impact",    "numerical", "work",      "ledger_defect", "broken_area",
        "fragments", "active",    "newton",    "krylov",        "residual"};

    std::vector<std::string> columns(const std::vector<std::string> &driven,
                                     const unsigned int dimension)
    {
      auto result = fixed_columns;
      for (const auto &name : driven)
        for (unsigned int d = 0; d < dimension; ++d)
          result.push_back("reaction_" + name + '_' + "xyz"[d]);
      return result;
    }
  } // namespace

  std::string HistoryFile::header(const std::vector<std::string> &driven,
                                  const unsigned int dimension)
  {
    return TableFile::header(columns(driven, dimension));
  }

  HistoryFile::HistoryFile(const std::string &path,
                           const std::vector<std::string> &driven,
                           const unsigned int dimension)
      : file_(path, columns(driven, dimension))
  {
  }

  HistoryFile::HistoryFile(const std::string &path,
                           const std::vector<std::string> &driven,
                           const unsigned int dimension,
                           const std::uintmax_t n_bytes)
      : file_(path, columns(driven, dimension), n_bytes)
  {
  }

  void HistoryFile::write(const HistoryRow &row)
  {
    const EnergyLines &e = row.energy;
    std::vector<double> line = {double(row.step),
                                row.time,
                                row.time_step,
                                e.kinetic,
                                e.elastic,
                                e.cohesive,
                                e.damage,
                                e.friction,
                                e.viscous,
                                e.plastic,
                                e.impact,
                                e.numerical,
                                e.work,
                                row.balance_residual,
                                row.broken_area,
                                double(row.fragments),
                                double(row.active),
                                double(row.newton),
                                double(row.krylov),
                                row.residual};
    line.insert(line.end(), row.reactions.begin(), row.reactions.end());
    file_.write(line);
  }

  std::vector<HistoryRow> HistoryFile::read(const std::string &path,
                                            const std::size_t n_reactions,
                                            const std::uintmax_t n_bytes)
  {
    const std::size_t n_fixed = fixed_columns.size();
    std::vector<HistoryRow> rows;
    for (const auto &x :
         TableFile::read(path, n_fixed + n_reactions, n_bytes)) {
      HistoryRow &row = rows.emplace_back();
      row.step = unsigned(x[0]);
      row.time = x[1];
      row.time_step = x[2];
      row.energy = {x[3], x[4], x[5],  x[6],  x[7],
                    x[8], x[9], x[10], x[11], x[12]};
      row.balance_residual = x[13];
      row.broken_area = x[14];
      row.fragments = unsigned(x[15]);
      row.active = unsigned(x[16]);
      row.newton = unsigned(x[17]);
      row.krylov = unsigned(x[18]);
      row.residual = x[19];
      row.reactions.assign(x.begin() + long(n_fixed), x.end());
    }
    return rows;
  }
} // namespace nsfd
