#include "nsfd/output/table_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
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

    /** A line of numbers; empty if it is none. */
    std::vector<double> numbers_of(const std::string &line, const std::size_t n)
    {
      std::vector<double> numbers;
      const char *next = line.c_str();
      while (numbers.size() < n) {
        char *end = nullptr;
        numbers.push_back(std::strtod(next, &end));
        if (end == next || (*end != ',' && *end != '\0'))
          break;
        if (*end == '\0')
          return numbers.size() == n ? numbers : std::vector<double>();
        next = end + 1;
      }
      return {};
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
      : path_(path), n_columns_(columns.size()), file_(path)
  {
    write_line(header(columns));
  }

  TableFile::TableFile(const std::string &path,
                       const std::vector<std::string> &columns,
                       const std::uintmax_t n_bytes)
      : path_(path), n_columns_(columns.size())
  {
    std::filesystem::resize_file(path, n_bytes);
    file_.open(path, std::ios::app);
    if (!file_)
      throw std::runtime_error("Cannot write '" + path + "'.");
  }

  void TableFile::write(const std::vector<double> &row)
  {
    if (row.size() != n_columns_)
      throw std::logic_error(
          fmt::format("A row of '{}' has {} columns, not {}.", path_,
                      n_columns_, row.size()));
    write_line(fmt::format("{}", fmt::join(row, ",")));
  }

  void TableFile::write_line(const std::string &line)
  {
    file_ << line << '\n' << std::flush;
    if (!file_)
      throw std::runtime_error("Cannot write '" + path_ + "'.");
  }

  std::uintmax_t TableFile::n_bytes()
  {
    file_.flush();
    const int file = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
    if (file >= 0) {
      fsync(file);
      close(file);
    }
    std::error_code error; // a file that is gone has none
    const std::uintmax_t size = std::filesystem::file_size(path_, error);
    return error ? 0 : size;
  }

  std::vector<std::vector<double>>
  TableFile::read(const std::string &path, const std::size_t n_columns,
                  const std::uintmax_t n_bytes)
  {
    std::ifstream file(path, std::ios::binary);
    std::string text(n_bytes, '\0');
    file.read(text.data(), std::streamsize(n_bytes));
    if (!file)
      throw std::runtime_error(
          fmt::format("'{}' is shorter than it was at the checkpoint", path));
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line); // the header
    std::vector<std::vector<double>> rows;
    while (std::getline(lines, line)) {
      rows.push_back(numbers_of(line, n_columns));
      if (rows.back().empty() || text.back() != '\n')
        throw std::runtime_error(fmt::format(
            "'{}', line {}, is not what it was at the checkpoint", path,
            rows.size() + 1));
    }
    return rows;
  }
} // namespace nsfd
