#include "load_plug_in.h"

#include "mix_bits.h"
#include "nsfd/core/plug_in.h"
#include "version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cxxabi.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    std::vector<PlugIn> &loaded()
    {
      static std::vector<PlugIn> plug_ins;
      return plug_ins;
    }

    /** The one whose code runs at the moment. */
    struct Loading {
      PlugIn plug_in;
      std::vector<std::string> refused; ///< names, and who has them
    };
    Loading *loading = nullptr;

    std::string bytes_of(const std::string &file)
    {
      std::error_code error;
      if (!fs::exists(file, error))
        throw PlugInError(file, "there is no such file", "");
      std::ifstream stream(file, std::ios::binary);
      std::ostringstream bytes;
      if (!fs::is_regular_file(file, error) || !stream)
        throw PlugInError(file, "it cannot be read", "");
      bytes << stream.rdbuf();
      return bytes.str();
    }

    std::string checksum(const std::string &bytes)
    {
      return fmt::format("{:016x}",
                         mixed(bytes.size(), bytes.data(), bytes.size()));
    }

    const char *const how_to_build =
        "a plug-in is what nsfd_add_plug_in() of nsfd's CMake package builds";

    /** Name and NSFD_BUILT_FOR, from the bytes of a file. */
    struct Identity {
      std::string name, built_for;
    };
    Identity identity_of(const std::string &file, const std::string &bytes)
    {
      if (bytes.compare(0, 4, "\177ELF") != 0)
        throw PlugInError(file, "it is not a shared library", how_to_build);
      const std::string mark = NSFD_PLUG_IN_MARK;
      const std::size_t begin = bytes.find(mark);
      const std::string text =
          begin == std::string::npos
              ? ""
              : std::string(bytes.c_str() + begin + mark.size());
      const std::size_t middle = text.find("; ");
      if (middle == std::string::npos)
        throw PlugInError(file,
                          "it is a shared library, but no plug-in of nsfd: it "
                          "does not say what it was built against",
                          how_to_build);
      return {text.substr(0, middle), text.substr(middle + 2)};
    }

    /** Where this program is installed, as CMake is told. */
    std::string prefix()
    {
      std::error_code error;
      const fs::path program = fs::read_symlink("/proc/self/exe", error);
      const fs::path folder = program.parent_path().parent_path();
      return fs::exists(folder / "lib/cmake/nsfd", error) ? folder.string()
                                                          : "PREFIX";
    }

    void check_identity(const std::string &file, const Identity &identity)
    {
      if (identity.built_for == version().interface)
        return;
      throw PlugInError(
          file,
          fmt::format("the plug-in `{}` was built against {}; this program is "
                      "{}",
                      identity.name, identity.built_for, version().interface),
          fmt::format("build it again against this one: cmake -S FOLDER -B "
                      "BUILD -DCMAKE_PREFIX_PATH={} && cmake --build BUILD",
                      prefix()));
    }

    /** What dlopen() has to say, names of functions as they are written. */
    std::string readable(std::string text, const std::string &file)
    {
      if (text.compare(0, file.size() + 2, file + ": ") == 0)
        text.erase(0, file.size() + 2);
      const std::string undefined = "undefined symbol: ";
      if (text.compare(0, undefined.size(), undefined) != 0)
        return "it cannot be loaded: " + text;
      const std::string symbol = text.substr(undefined.size());
      int status = 0;
      const std::unique_ptr<char, decltype(&std::free)> demangled(
          abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status),
          std::free);
      const std::string name = demangled ? demangled.get() : symbol;
      const std::string vtable = "vtable for ";
      if (name.compare(0, vtable.size(), vtable) == 0)
        return fmt::format("a virtual function of `{}` is declared and not "
                           "defined",
                           name.substr(vtable.size()));
      return fmt::format("it needs `{}`, which neither it nor this program has",
                         name);
    }

    void run_its_code(Loading &now)
    {
      const std::string file = now.plug_in.file;
      loading = &now;
      // names stay its own: two plug-ins may have classes of one name
      const void *library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
      loading = nullptr;
      if (library == nullptr) {
        const char *why = dlerror();
        throw PlugInError(file, readable(why ? why : "no reason given", file),
                          "what is declared must be defined in its sources, "
                          "and only headers of include/nsfd may be used");
      }
      if (!now.refused.empty())
        throw PlugInError(
            file,
            fmt::format("the plug-in `{}` registers a name that is taken: {}",
                        now.plug_in.name, fmt::join(now.refused, ", ")),
            "give its parts other names");
      if (now.plug_in.parts.empty())
        throw PlugInError(
            file,
            fmt::format("the plug-in `{}` registers nothing", now.plug_in.name),
            "each part needs a line NSFD_REGISTER(...)");
    }
  } // namespace

  const std::vector<PlugIn> &loaded_plug_ins() { return loaded(); }

  std::string plug_ins::owner_of(const std::string &name)
  {
    if (!loading)
      return "";
    loading->plug_in.parts.push_back(name);
    return loading->plug_in.name;
  }

  void plug_ins::refuse_name(const std::string &name, const std::string &owner)
  {
    const std::string whose =
        owner.empty() ? "of the program" : "of the plug-in `" + owner + "`";
    if (loading) {
      loading->refused.push_back(fmt::format("`{}` {}", name, whose));
      return;
    }
    // two files of the program: seen at its first start
    std::cerr << "two parts register the name `" << name << "`\n";
    std::abort();
  }

  void plug_ins::note_use(const std::string &plug_in)
  {
    for (PlugIn &one : loaded())
      if (one.name == plug_in)
        one.used = true;
  }

  void load_plug_in(const std::string &file)
  {
    const std::string bytes = bytes_of(file);
    Loading now;
    now.plug_in.file = fs::canonical(file).string();
    for (const PlugIn &other : loaded())
      if (other.file == now.plug_in.file)
        return;
    const Identity identity = identity_of(file, bytes);
    check_identity(file, identity);
    for (const PlugIn &other : loaded())
      if (other.name == identity.name)
        throw PlugInError(file,
                          fmt::format("a plug-in `{}` is loaded already: {}",
                                      other.name, other.file),
                          "load one of the two");
    now.plug_in.name = identity.name;
    now.plug_in.checksum = checksum(bytes);
    run_its_code(now);
    loaded().push_back(now.plug_in);
  }

  std::string used_plug_ins()
  {
    std::string text;
    for (const PlugIn &one : loaded())
      if (one.used)
        text += one.name + " " + one.checksum + "\n";
    return text;
  }

  void load_plug_ins_of(const std::string &folders)
  {
    std::istringstream stream(folders);
    for (std::string folder; std::getline(stream, folder, ':');) {
      if (folder.empty())
        continue;
      std::error_code error;
      std::vector<std::string> files;
      for (const auto &entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".so")
          files.push_back(entry.path().string());
      if (error)
        throw PlugInError(folder, "NSFD_PLUG_INS names no folder here",
                          "it is a list of folders with colons in between");
      std::sort(files.begin(), files.end());
      for (const std::string &file : files)
        load_plug_in(file);
    }
  }
} // namespace nsfd
