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

    std::vector<std::string> names(const HistoryFile::Columns &columns)
    {
      auto result = fixed_columns;
      for (const auto &name : columns.driven)
        for (unsigned int d = 0; d < columns.dimension; ++d)
          result.push_back("reaction_" + name + '_' + "xyz"[d]);
      if (columns.absorbed)
        result.push_back("absorbed");
      if (columns.heat)
        result.insert(result.end(), {"heat", "heat_stored", "hottest"});
      if (columns.heated_sides)
        result.push_back("heat_given");
      if (columns.load_time)
        result.push_back("load_time");
      return result;
    }
  } // namespace

  std::string HistoryFile::header(const Columns &columns)
  {
    return TableFile::header(names(columns));
  }

  HistoryFile::HistoryFile(const std::string &path, const Columns &columns)
      : absorbed_(columns.absorbed), heat_(columns.heat),
        heated_sides_(columns.heated_sides), load_time_(columns.load_time),
        file_(path, names(columns))
  {
  }

  HistoryFile::HistoryFile(const std::string &path, const Columns &columns,
                           const std::uintmax_t n_bytes)
      : absorbed_(columns.absorbed), heat_(columns.heat),
        heated_sides_(columns.heated_sides), load_time_(columns.load_time),
        file_(path, names(columns), n_bytes)
  {
  }

  void HistoryFile::write(const HistoryRow &row, const double load_time)
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
    if (absorbed_)
      line.push_back(e.absorbed);
    if (heat_) {
      const HeatRecord heat = row.heat.value_or(HeatRecord());
      line.insert(line.end(), {heat.made, heat.stored, heat.hottest});
      if (heated_sides_)
        line.push_back(heat.given);
    }
    if (load_time_)
      line.push_back(load_time);
    file_.write(line);
  }

  std::vector<HistoryRow> HistoryFile::read(const std::string &path,
                                            const Columns &columns,
                                            const std::uintmax_t n_bytes)
  {
    const std::size_t n_fixed = fixed_columns.size();
    std::vector<HistoryRow> rows;
    for (const auto &x :
         TableFile::read(path, names(columns).size(), n_bytes)) {
      HistoryRow &row = rows.emplace_back();
      row.step = unsigned(x[0]);
      row.time = x[1];
      row.time_step = x[2];
      auto &e = row.energy;
      double *const lines[] = {&e.kinetic,   &e.elastic, &e.cohesive, &e.damage,
                               &e.friction,  &e.viscous, &e.plastic,  &e.impact,
                               &e.numerical, &e.work};
      for (unsigned int k = 0; k < 10; ++k)
        *lines[k] = x[3 + k];
      row.balance_residual = x[13];
      row.broken_area = x[14];
      row.fragments = unsigned(x[15]);
      row.active = unsigned(x[16]);
      row.newton = unsigned(x[17]);
      row.krylov = unsigned(x[18]);
      row.residual = x[19];
      const auto reactions = x.begin() + long(n_fixed);
      auto next = reactions + long(columns.n_reactions());
      row.reactions.assign(reactions, next);
      if (columns.absorbed)
        e.absorbed = *next++;
      if (columns.heat)
        row.heat = HeatRecord{next[0], next[1], next[2],
                              columns.heated_sides ? next[3] : 0.};
    }
    return rows;
  }
} // namespace nsfd
