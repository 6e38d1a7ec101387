#include "row_file.h"

#include "core/output_folder.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace nsfd
{
  RowFile::RowFile(const std::string &path, const std::string &header)
      : path_(path)
  {
    OutputFolder::instance().note(path);
    errno = 0;
    file_.open(path);
    write(header);
  }

  RowFile::RowFile(const std::string &path, const std::uintmax_t n_bytes)
      : path_(path)
  {
    if (std::filesystem::is_symlink(path))
      throw OutputError("Cannot write '" + path_ +
                        "': it is a link, and links are not followed.");
    OutputFolder::instance().note(path);
    std::filesystem::resize_file(path, n_bytes);
    errno = 0;
    file_.open(path, std::ios::app);
    demand_good();
  }

  void RowFile::write(const std::string &lines)
  {
    errno = 0;
    file_ << lines << '\n' << std::flush;
    demand_good();
  }

  void RowFile::demand_good() const
  {
    const int reason = errno;
    if (!file_)
      throw OutputError("Cannot write '" + path_ + "': " +
                        (reason ? std::strerror(reason) : "it failed") + '.');
  }

  std::uintmax_t RowFile::n_bytes()
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

  std::string read_rows(const std::string &path, const std::uintmax_t n_bytes)
  {
    std::ifstream file(path, std::ios::binary);
    std::string text(n_bytes, '\0');
    file.read(text.data(), std::streamsize(n_bytes));
    if (!file)
      throw std::runtime_error(
          fmt::format("'{}' is shorter than it was at the checkpoint", path));
    return text;
  }

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
} // namespace nsfd
