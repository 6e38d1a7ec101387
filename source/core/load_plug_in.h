#pragma once

#include <stdexcept>
#include <string>

namespace nsfd
{
  /** A plug-in that cannot be loaded: its file, why, and what to do. */
  class PlugInError : public std::runtime_error
  {
  public:
    PlugInError(const std::string &file, const std::string &message,
                const std::string &advice)
        : std::runtime_error(message), file_(file), advice_(advice)
    {
    }
    const std::string &file() const { return file_; }
    const std::string &advice() const { return advice_; }

  private:
    std::string file_, advice_;
  };

  /**
   * Load a library whose parts register themselves. What it was built against
   * is read from its bytes first: none of its code runs if that is not this
   * program. A file that is loaded already is left alone. Errors raised:
   * PlugInError; the process should then end, parts may be there by halves.
   */
  void load_plug_in(const std::string &file);

  /** "name checksum", a line each, of those that the scene uses: whose change
   * gives a run another meaning. */
  std::string used_plug_ins();

  /** All `*.so` of folders between colons, by folder and name. */
  void load_plug_ins_of(const std::string &folders);
} // namespace nsfd
