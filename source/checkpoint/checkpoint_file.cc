#include "checkpoint_file.h"

#include "core/mix_bits.h"

#include "core/output_folder.h"
#include "core/version.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

namespace nsfd::checkpoint_file
{
  namespace fs = std::filesystem;

  namespace
  {
    const char *const title = "nsfd checkpoint";

    /** Of everything after the head. */
    std::uint64_t checksum(const std::vector<char> &bytes)
    {
      const std::size_t head = std::min<std::size_t>(head_size, bytes.size());
      return mixed(bytes.size(), bytes.data() + head, bytes.size() - head);
    }

    /** A file that is open for writing, removed unless it is kept. */
    class NewFile
    {
    public:
      explicit NewFile(const fs::path &path) : path_(path)
      {
        std::remove(path.c_str()); // a link would be followed
        file_ =
            open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        demand(file_ >= 0);
      }
      ~NewFile()
      {
        if (file_ >= 0)
          close(file_);
        if (!kept_)
          std::remove(path_.c_str());
      }
      NewFile(const NewFile &) = delete;
      NewFile &operator=(const NewFile &) = delete;

      void write_all(const std::vector<char> &bytes)
      {
        for (std::size_t done = 0; done < bytes.size();) {
          const ssize_t n =
              write(file_, bytes.data() + done, bytes.size() - done);
          if (n < 0 && errno == EINTR)
            continue;
          demand(n > 0);
          done += std::size_t(n);
        }
        demand(fsync(file_) == 0);
        const int closed = close(file_);
        file_ = -1;
        demand(closed == 0);
      }

      void keep() { kept_ = true; }

    private:
      void demand(const bool good) const
      {
        if (!good)
          throw std::runtime_error(
              fmt::format("{}: {}", path_.string(), std::strerror(errno)));
      }

      const fs::path path_;
      int file_ = -1;
      bool kept_ = false;
    };

    void move(const fs::path &from, const fs::path &to)
    {
      if (std::rename(from.c_str(), to.c_str()) != 0)
        throw std::runtime_error(
            fmt::format("{}: {}", to.string(), std::strerror(errno)));
    }

    /** Names, too, must reach the disk. */
    void sync_folder(const fs::path &folder)
    {
      const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      if (file < 0)
        return;
      fsync(file);
      close(file);
    }
  } // namespace

  std::string program() { return version().number + " " + version().git_hash; }

  void seal(std::vector<char> &bytes)
  {
    const std::string head = fmt::format(
        "{}\nformat {}\nprogram {}\nbytes {}\nchecksum {:016x}\n", title,
        format, version().number, bytes.size(), checksum(bytes));
    std::fill_n(bytes.begin(), head_size, '\0');
    std::copy_n(head.begin(), std::min(head.size(), head_size - 1),
                bytes.begin());
  }

  std::string problem_of(const std::vector<char> &bytes)
  {
    std::string head(bytes.begin(),
                     bytes.begin() + long(std::min(bytes.size(), head_size)));
    if (head.compare(0, std::strlen(title), title) != 0)
      return bytes.empty() ? "it is empty" : "it is no checkpoint of nsfd";
    std::istringstream lines(head.substr(std::strlen(title)));
    std::string names[4], program, sum;
    unsigned int its_format = 0;
    std::size_t size = 0;
    lines >> names[0] >> its_format >> names[1] >> program >> names[2] >>
        size >> names[3] >> sum;
    if (lines && its_format != format)
      return fmt::format("nsfd {} has written it, in format {}; this program "
                         "({}) knows format {}",
                         program, its_format, version().number, format);
    if (!lines || bytes.size() < size)
      return fmt::format("it is cut short: {} bytes of {}", bytes.size(), size);
    if (names[0] != "format" || names[1] != "program" || names[2] != "bytes" ||
        names[3] != "checksum" || bytes.size() != size ||
        fmt::format("{:016x}", checksum(bytes)) != sum)
      return "its checksum is wrong: it is damaged";
    return "";
  }

  std::vector<char> read(const fs::path &file)
  {
    std::error_code unknown;
    if (!fs::is_regular_file(file, unknown))
      throw std::runtime_error(fmt::format(
          "{}: it is no file, but a folder or a device", file.string()));
    errno = 0;
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream)
      throw std::runtime_error(
          fmt::format("{}: {}", file.string(), std::strerror(errno)));
    std::vector<char> bytes(std::size_t(stream.tellg()));
    stream.seekg(0);
    stream.read(bytes.data(), std::streamsize(bytes.size()));
    if (!stream)
      throw std::runtime_error(
          fmt::format("{}: it cannot be read", file.string()));
    return bytes;
  }

  std::vector<fs::path> candidates(const fs::path &folder)
  {
    return {folder / "checkpoint.h5", folder / "checkpoint_previous.h5"};
  }

  void put(const fs::path &folder, const std::vector<char> &bytes)
  {
    const auto places = candidates(folder);
    const fs::path part = folder / "checkpoint.h5.part";
    for (const fs::path &place : places)
      OutputFolder::instance().note(place.string());
    NewFile file(part);
    file.write_all(bytes);
    if (fs::exists(places[0]))
      move(places[0], places[1]);
    move(part, places[0]);
    file.keep();
    sync_folder(folder);
  }
} // namespace nsfd::checkpoint_file
