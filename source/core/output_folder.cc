#include "output_folder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <vector>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;
    using Json = nlohmann::ordered_json;

    const char *const list_name = "run.json";

    /** Of runs whose run.json has no list: the files that every run promises.
     */
    const std::vector<std::string> promised = {
        "parameters.prm", "run.json",      "units.json",
        "history.csv",    "summary.json",  "fields.pvd",
        "interfaces.pvd", "checkpoint.h5", "report.html"};

    /** Those of many runs. */
    const std::vector<std::string> frequent = {
        "checkpoint_previous.h5", "fields.xdmf",   "fields.h5",
        "interfaces.xdmf",        "interfaces.h5", "fragments.csv"};

    bool refuse(const std::string &text)
    {
      std::cerr << text << "\n";
      return false;
    }

    fs::file_type type_of(const fs::path &path)
    {
      std::error_code error;
      return fs::symlink_status(path, error).type();
    }

    bool is_there(const fs::path &path)
    {
      const fs::file_type type = type_of(path);
      return type != fs::file_type::not_found && type != fs::file_type::none;
    }

    /** Relative, and below the folder. */
    bool stays_inside(const fs::path &name)
    {
      if (name.empty() || name.is_absolute())
        return false;
      for (const fs::path &part : name)
        if (part == "..")
          return false;
      return true;
    }

    /** No part of the way to a file in @p folder is a link. */
    bool is_reached_without_links(const fs::path &folder, const fs::path &name)
    {
      fs::path way = folder;
      for (const fs::path &part : name.parent_path()) {
        way /= part;
        if (type_of(way) == fs::file_type::symlink)
          return false;
      }
      return true;
    }

    Json read_description(const fs::path &folder)
    {
      std::ifstream stream(folder / list_name, std::ios::binary);
      std::ostringstream text;
      text << stream.rdbuf();
      return Json::parse(text.str(), nullptr, false);
    }

    /** What the run in @p folder has written; nothing if there was none. */
    std::vector<std::string> listed(const fs::path &folder)
    {
      if (type_of(folder / list_name) != fs::file_type::regular)
        return {};
      const Json json = read_description(folder);
      if (!json.is_object())
        return {};
      if (!json.contains("files"))
        return promised;
      std::vector<std::string> names = {list_name};
      for (const Json &name : json["files"])
        if (name.is_string() && stays_inside(name.get<std::string>()))
          names.push_back(name.get<std::string>());
      return names;
    }

    /** What a run that was killed at its very first file leaves does not count.
     */
    bool is_free(const fs::path &folder)
    {
      std::error_code error;
      for (const auto &entry : fs::directory_iterator(folder, error))
        if (entry.path().filename() != std::string(list_name) + ".part")
          return false;
      return true;
    }

    /** The process of this machine that has locked the folder, 0 if none. */
    long holder_of(const std::string &directory)
    {
      struct stat status = {};
      if (stat(directory.c_str(), &status) != 0)
        return 0;
      const std::string inode =
          fmt::format("{:02x}:{:02x}:{}", major(status.st_dev),
                      minor(status.st_dev), status.st_ino);
      std::ifstream locks("/proc/locks");
      for (std::string line; std::getline(locks, line);) {
        std::istringstream words(line);
        std::string number, kind, rule, access, place;
        long process = 0;
        if (words >> number >> kind >> rule >> access >> process >> place &&
            kind == "FLOCK" && place == inode)
          return process;
      }
      return 0;
    }

    std::string host_name()
    {
      char host[256] = "";
      gethostname(host, sizeof(host) - 1);
      return host;
    }

    std::string other_run(const std::string &directory)
    {
      if (const long process = holder_of(directory))
        return fmt::format("process {} on {}", process, host_name());
      const Json json = read_description(directory);
      if (json.is_object() && json.contains("host") && json["host"].is_string())
        return "another process, perhaps on " + json["host"].get<std::string>();
      return "another process";
    }
  } // namespace

  OutputFolder &OutputFolder::instance()
  {
    static OutputFolder folder;
    return folder;
  }

  /** Held until the process ends, however it does. */
  bool OutputFolder::lock(const std::string &directory)
  {
    const int file =
        open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
      return refuse(fmt::format("cannot open the output directory `{}`: {}",
                                directory, std::strerror(errno)));
    if (flock(file, LOCK_EX | LOCK_NB) == 0)
      return true; // the file stays open
    const int reason = errno;
    close(file);
    if (reason == EWOULDBLOCK)
      return refuse(fmt::format(
          "the output directory `{}` is in use by {}: nothing was run.\n"
          "  wait until it has ended, or write --output DIR",
          directory, other_run(directory)));
    std::cerr << fmt::format(
        "note: the output directory `{}` cannot be locked ({}): see that no "
        "other run writes to it\n",
        directory, std::strerror(reason));
    return true;
  }

  bool OutputFolder::may_replace(const std::string &directory)
  {
    const fs::path folder(directory);
    const auto names = listed(folder);
    if (names.empty())
      return refuse(fmt::format(
          "the output directory `{}` holds files, but no run.json of a run "
          "that --force could replace: nothing was run.\n"
          "  write --output DIR with another one",
          directory));
    if (read_description(folder).contains("files"))
      for (const std::vector<std::string> *all : {&promised, &frequent})
        for (const std::string &name : *all)
          if (is_there(folder / name) &&
              std::find(names.begin(), names.end(), name) == names.end())
            return refuse(fmt::format(
                "`{}` is not of the run that --force would replace, and a new "
                "run might: nothing was run.\n"
                "  move it away, or write --output DIR",
                (folder / name).string()));
    for (const std::string &name : names)
      if (type_of(folder / name) == fs::file_type::directory)
        return refuse(fmt::format(
            "`{}` is a folder, not the file of a run: nothing was run.\n"
            "  move it away, or write --output DIR",
            (folder / name).string()));
    return true;
  }

  bool OutputFolder::claim(const std::string &directory, const Claim how)
  {
    std::error_code error;
    const fs::path folder(directory);
    const bool existed = is_there(folder);
    if (existed && !fs::is_directory(folder, error))
      return refuse(fmt::format(
          "the output directory `{}` is no folder: nothing was run.\n"
          "  write --output DIR with another name",
          directory));
    if (!existed && how == Claim::go_on)
      return refuse(
          fmt::format("there is no folder `{}`: nothing was run", directory));
    fs::create_directories(folder, error);
    if (error)
      return refuse(fmt::format("cannot create the output directory `{}`: {}",
                                directory, error.message()));
    if (access(directory.c_str(), W_OK | X_OK) != 0)
      return refuse(fmt::format("cannot write to the output directory `{}`: {}",
                                directory, std::strerror(errno)));
    if (!lock(directory))
      return false;
    files_.clear();
    head_.clear();
    if (how == Claim::go_on) {
      for (const std::string &name : listed(folder))
        files_.insert(name);
    } else if (!is_free(folder)) {
      if (how == Claim::anew) {
        const bool stored = is_there(folder / "checkpoint.h5");
        return refuse(
            fmt::format("the output directory `{}` exists already: nothing "
                        "was run.\n  write {}--output DIR",
                        directory,
                        listed(folder).empty() ? ""
                        : stored ? "--force to replace it, --resume to go on, "
                                   "or "
                                 : "--force to replace it, or "));
      }
      if (!may_replace(directory))
        return false;
      std::set<fs::path> below; // may be empty afterwards
      for (const fs::path name : listed(folder)) {
        if (!is_reached_without_links(folder, name))
          continue; // what is there is elsewhere
        if (name == list_name)
          continue; // replaced below: a kill here leaves a list
        fs::remove(folder / (name.string() + ".part"), error); // cut off
        fs::remove(folder / name, error);
        if (error)
          return refuse(fmt::format("cannot replace `{}`: {}",
                                    (folder / name).string(), error.message()));
        if (name.has_parent_path())
          below.insert(name.parent_path());
      }
      for (auto part = below.rbegin(); part != below.rend(); ++part)
        fs::remove(folder / *part, error); // unless it holds other files
    }
    directory_ = directory;
    if (how != Claim::go_on)
      write_list();
    return true;
  }

  void OutputFolder::describe(const std::string &json)
  {
    if (directory_.empty())
      return;
    head_ = json;
    files_.insert(promised.begin(), promised.end()); // some at once
    write_list();
  }

  void OutputFolder::write_list()
  {
    const auto start = std::chrono::steady_clock::now();
    changed_ = false;
    files_.insert(list_name);
    Json json = Json::parse(head_, nullptr, false);
    if (!json.is_object())
      json = Json::object();
    json["process"] = long(getpid());
    json["files"] = files_;
    write_file_atomically(
        directory_ + '/' + list_name,
        json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
    listed_ = std::chrono::steady_clock::now();
    cost_ = listed_ - start;
  }

  void OutputFolder::note(const std::string &path)
  {
    const fs::path file(path);
    const auto type = type_of(file);
    std::error_code error;
    if (type == fs::file_type::symlink)
      fs::remove(file, error);
    if (type == fs::file_type::directory)
      throw OutputError("Cannot write '" + path + "': it is a folder.");
    if (directory_.empty())
      return;
    const fs::path folder(directory_),
        name = file.lexically_normal().lexically_relative(
            folder.lexically_normal());
    if (!stays_inside(name))
      return;
    if (!is_reached_without_links(folder, name))
      throw OutputError("Cannot write '" + path +
                        "': a part of its path is a link, and links are not "
                        "followed.");
    const std::lock_guard<std::recursive_mutex> guard(mutex_);
    changed_ |= files_.insert(name.generic_string()).second;
    // a long list may be a little late
    if (changed_ && !head_.empty() && name != list_name &&
        (files_.size() < 200 ||
         std::chrono::steady_clock::now() - listed_ > 50 * cost_))
      write_list();
  }

  void OutputFolder::finish()
  {
    if (directory_.empty())
      return;
    for (auto name = files_.begin(); name != files_.end();)
      if (*name != list_name && !is_there(fs::path(directory_) / *name))
        name = files_.erase(name);
      else
        ++name;
    write_list();
  }

  std::optional<std::string> writer_of(const std::string &directory)
  {
    const int file =
        open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
      return std::nullopt;
    const bool locked =
        flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(file);
    if (!locked)
      return std::nullopt;
    return other_run(directory);
  }

  bool claim_directory(const std::string &directory, const bool force)
  {
    return OutputFolder::instance().claim(directory,
                                          force ? OutputFolder::Claim::replace
                                                : OutputFolder::Claim::anew);
  }

  void write_file_atomically(const std::string &path, const std::string &text)
  {
    write_file_atomically(path, std::vector<std::string_view>{text});
  }

  void write_file_atomically(const std::string &path,
                             const std::vector<std::string_view> &parts)
  {
    const std::string temporary = path + ".part";
    const auto fail = [&]() {
      const std::string reason = std::strerror(errno);
      std::remove(temporary.c_str());
      throw OutputError("Cannot write '" + path + "': " + reason + '.');
    };

    OutputFolder::instance().note(path);
    std::remove(temporary.c_str()); // a link would be followed
    const int file =
        open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0)
      fail();
    for (std::string_view left : parts)
      while (!left.empty()) {
        const ssize_t n = write(file, left.data(), left.size());
        if (n < 0 && errno == EINTR)
          continue;
        if (n <= 0) {
          const int reason = errno;
          close(file);
          errno = reason;
          fail();
        }
        left.remove_prefix(std::size_t(n));
      }
    if (close(file) != 0 || std::rename(temporary.c_str(), path.c_str()) != 0)
      fail();
  }
} // namespace nsfd
