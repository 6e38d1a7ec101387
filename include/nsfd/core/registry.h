#pragma once

#include "nsfd/core/plug_in.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Named factories of one kind of part. A part registers itself from its own
   * source file with NSFD_REGISTER; nothing else has to be edited. Names are
   * what a parameter file writes, texts are what `--list` prints.
   */
  template <typename Base, typename... Arguments>
  class Registry
  {
  public:
    using Factory = std::function<std::unique_ptr<Base>(Arguments...)>;

    struct Entry {
      Factory factory;
      std::string text;
      std::vector<std::string> examples;
      std::string plug_in; ///< that it comes from; empty: the program
    };

    static Registry &instance()
    {
      static Registry registry;
      return registry;
    }

    /** For NSFD_REGISTER; what examples are is explained there. */
    template <typename Part, typename... Examples>
    bool add(const std::string &name, const std::string &text,
             const Examples &...examples)
    {
      const Factory factory = [](Arguments... arguments) {
        return std::make_unique<Part>(std::forward<Arguments>(arguments)...);
      };
      const auto [entry, is_new] = entries_.try_emplace(name);
      if (is_new)
        entry->second = {
            factory, text, {examples...}, plug_ins::owner_of(name)};
      else
        plug_ins::refuse_name(name, entry->second.plug_in);
      return is_new;
    }

    bool knows(const std::string &name) const
    {
      return entries_.count(name) != 0;
    }

    std::unique_ptr<Base> create(const std::string &name,
                                 Arguments... arguments) const
    {
      const Entry &entry = entries_.at(name);
      plug_ins::note_use(entry.plug_in);
      return entry.factory(arguments...);
    }

    const std::map<std::string, Entry> &entries() const { return entries_; }

    std::vector<std::string> names() const
    {
      std::vector<std::string> result;
      for (const auto &entry : entries_)
        result.push_back(entry.first);
      return result;
    }

  private:
    std::map<std::string, Entry> entries_;
  };
} // namespace nsfd

#define NSFD_CONCATENATE_2(a, b) a##b
#define NSFD_CONCATENATE(a, b) NSFD_CONCATENATE_2(a, b)

/**
 * Register a class under a name, with the one line that `--list` prints:
 *
 *   NSFD_REGISTER(RegistryType, Class, name, text, example, ...);
 *
 * The class is built with the registry's arguments. A part that reads entries
 * of its own may state examples of them, "strength = 3 MPa; toughness = 4
 * J/m^2": each one is enough to build the part. The contract tests try them
 * all; `--list` and doc/parameters.md show the first.
 */
#define NSFD_REGISTER(RegistryType, Class, ...)                                \
  static const bool NSFD_CONCATENATE(registered_, __COUNTER__) =               \
      RegistryType::instance().add<Class>(__VA_ARGS__)
