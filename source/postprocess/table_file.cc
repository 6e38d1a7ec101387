#include "table_file.h"

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

  std::string TableFile::header(const std::vector<std::string> &columns)
  {
    std::string line;
    for (const auto &name : columns)
      line += (line.empty() ? "" : ",") + csv_name(name);
    return line;
  }

  TableFile::TableFile(const std::string &path,
                       const std::vector<std::string> &columns)
      : n_columns_(columns.size()), rows_(path, header(columns))
  {
  }

  TableFile::TableFile(const std::string &path,
                       const std::vector<std::string> &columns,
                       const std::uintmax_t n_bytes)
      : n_columns_(columns.size()), rows_(path, n_bytes)
  {
  }

  void TableFile::write(const std::vector<double> &row)
  {
    if (row.size() != n_columns_)
      throw std::logic_error(
          fmt::format("A row of '{}' has {} columns, not {}.", rows_.path(),
                      n_columns_, row.size()));
    rows_.write(fmt::format("{}", fmt::join(row, ",")));
  }

  std::vector<std::vector<double>> TableFile::read(const std::string &path,
                                                   const std::size_t n_columns,
                                                   const std::uintmax_t n_bytes)
  {
    const std::string text = read_rows(path, n_bytes);
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line); // the header
    std::vector<std::vector<double>> rows;
    while (std::getline(lines, line)) {
      rows.push_back(numbers_of(line, n_columns));
      if (rows.back().empty() || text.back() != '\n')
        throw std::runtime_error(
            fmt::format("'{}', line {}, is not what it was at the checkpoint",
                        path, rows.size() + 1));
    }
    return rows;
  }
} // namespace nsfd
