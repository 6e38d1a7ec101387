#include "abaqus_deck.h"

#include "abaqus_elements.h"
#include "abaqus_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <istream>
#include <optional>

namespace nsfd::abaqus
{
  namespace
  {
    using Words = std::vector<std::string>;

    bool begins_with_digit(const std::string &text)
    {
      return !text.empty() && std::isdigit(static_cast<unsigned char>(text[0]));
    }

    void tidy(Set &set)
    {
      std::sort(set.members.begin(), set.members.end());
      set.members.erase(std::unique(set.members.begin(), set.members.end()),
                        set.members.end());
    }

    /// each of them makes nodes or elements that stand nowhere in the file
    const char *const generators[] = {"*NGEN",  "*NFILL",  "*NCOPY", "*NMAP",
                                      "*ELGEN", "*ELCOPY", "*SYSTEM"};

    class DeckReader
    {
    public:
      DeckReader(const unsigned int dimension,
                 std::vector<std::string> &problems)
          : dimension_(dimension), problems_(problems)
      {
        deck_.parts.emplace_back();
        deck_.instances.emplace_back();
      }

      Deck read(std::istream &in)
      {
        std::string line;
        while (std::getline(in, line) && problems_.empty()) {
          ++line_number_;
          line = trimmed(line);
          if (line.empty() || line.rfind("**", 0) == 0)
            continue;
          if (line[0] == '*' || keyword_.goes_on())
            open_keyword(line);
          else
            add_line(line);
        }
        if (problems_.empty())
          close_element();
        finish_parts();
        return std::move(deck_);
      }

    private:
      void problem(const std::string &message)
      {
        if (problems_.empty())
          problems_.push_back(
              fmt::format("line {}: {}", line_number_, message));
      }

      void open_keyword(const std::string &line)
      {
        if (!keyword_.goes_on())
          close_element();
        if (keyword_.take(line) && problems_.empty())
          begin_block();
      }

      void begin_block()
      {
        n_lines_ = 0;
        for (const char *word : generators)
          if (keyword_.is(word))
            return problem(fmt::format("{} is not read; write the mesh with "
                                       "all its nodes and elements",
                                       keyword_.name()));
        if (keyword_.is("*INCLUDE"))
          return problem("*INCLUDE is not followed; put the lines of the other "
                         "file in its place");
        if (keyword_.has("INPUT") &&
            (keyword_.is("*NODE") || keyword_.is("*ELEMENT") ||
             keyword_.is("*ELSET") || keyword_.is("*NSET")))
          return problem(fmt::format("INPUT={} is not followed; put the lines "
                                     "of this file in its place",
                                     keyword_.get("INPUT")));
        if (keyword_.is("*NODE") && keyword_.has("SYSTEM") &&
            upper(keyword_.get("SYSTEM")) != "R")
          return problem("coordinates that are not rectangular are not read; "
                         "write *NODE without SYSTEM");
        if (keyword_.is("*PART")) {
          deck_.parts.emplace_back();
          deck_.parts.back().name = keyword_.get("NAME");
          part_ = deck_.parts.size() - 1;
        } else if (keyword_.is("*END PART"))
          part_ = 0;
        else if (keyword_.is("*ASSEMBLY"))
          in_assembly_ = true;
        else if (keyword_.is("*END ASSEMBLY"))
          in_assembly_ = false;
        else if (keyword_.is("*INSTANCE"))
          begin_instance();
        else if (keyword_.is("*END INSTANCE"))
          instance_ = 0;
        else if (keyword_.is("*SURFACE"))
          begin_surface();
        else if (keyword_.is("*ELSET") || keyword_.is("*NSET"))
          begin_set();
        else if (keyword_.is("*ELEMENT") && keyword_.get("TYPE").empty())
          problem("*ELEMENT without TYPE; write for example: *ELEMENT, "
                  "TYPE=CPE4");
      }

      void begin_instance()
      {
        const std::string name = keyword_.get("PART");
        std::size_t part = 1;
        while (part < deck_.parts.size() &&
               upper(deck_.parts[part].name) != upper(name))
          ++part;
        if (part == deck_.parts.size())
          return problem(fmt::format("there is no part `{}` above", name));
        Instance instance;
        instance.name = keyword_.get("NAME");
        instance.part = part;
        deck_.instances.push_back(instance);
        instance_ = deck_.instances.size() - 1;
      }

      /** Where nodes, elements and sets of the present place belong. */
      Part *part()
      {
        if (instance_ == 0) {
          if (!in_assembly_)
            return &deck_.parts[part_];
          problem(fmt::format("{} stands in the assembly; nodes and elements "
                              "belong to a part or an instance",
                              keyword_.name()));
          return nullptr;
        }
        // the mesh of an independent instance stands in its own lines
        Instance &instance = deck_.instances[instance_];
        if (meshed_instance_ != instance_) {
          if (!deck_.parts[instance.part].nodes.empty()) {
            problem(fmt::format("the instance `{}` has a mesh of its own, and "
                                "its part has one, too",
                                instance.name));
            return nullptr;
          }
          deck_.parts.emplace_back();
          instance.part = deck_.parts.size() - 1;
          meshed_instance_ = instance_;
        }
        return &deck_.parts[instance.part];
      }

      Scope *scope()
      {
        return in_assembly_ && instance_ == 0 ? &deck_.assembly : part();
      }

      void begin_set()
      {
        const bool is_of_nodes = keyword_.is("*NSET");
        const std::string name = keyword_.get(is_of_nodes ? "NSET" : "ELSET");
        if (name.empty())
          return problem(fmt::format(
              "{} without a name; write for example: {}, {}=left",
              keyword_.name(), keyword_.name(), keyword_.name().substr(1)));
        if (Scope *const here = scope()) {
          Sets &sets = is_of_nodes ? here->node_sets : here->element_sets;
          Set &set =
              sets.emplace(upper(name), Set{name, false, {}}).first->second;
          set.is_internal |= keyword_.has("INTERNAL");
        }
      }

      void begin_surface()
      {
        const std::string type = upper(keyword_.get("TYPE"));
        takes_surface_ = type.empty() || type == "ELEMENT" || type == "NODE";
        if (keyword_.get("NAME").empty())
          return problem("*SURFACE without a name; write for example: "
                         "*SURFACE, NAME=left");
        if (keyword_.has("COMBINE"))
          return problem("*SURFACE with COMBINE is not read; write the faces "
                         "of the surface");
        if (!takes_surface_)
          return;
        Scope *const here = scope();
        if (here == nullptr)
          return;
        if (type == "NODE")
          here->node_sets.emplace(upper(keyword_.get("NAME")),
                                  Set{keyword_.get("NAME"), false, {}});
        else
          here->surfaces.push_back({keyword_.get("NAME"), {}});
      }

      void add_line(const std::string &line)
      {
        ++n_lines_;
        const Words words = fields(line);
        if (keyword_.is("*NODE"))
          add_node(words);
        else if (keyword_.is("*ELEMENT"))
          continue_element(line, words);
        else if (keyword_.is("*ELSET") || keyword_.is("*NSET"))
          add_to_set(words);
        else if (keyword_.is("*SURFACE") && takes_surface_)
          add_to_surface(words);
        else if (keyword_.is("*INSTANCE"))
          place_instance(words);
      }

      std::optional<long> label(const std::string &text)
      {
        const std::optional<long> value = integer(text);
        if (!value)
          problem(fmt::format("`{}` is not an integer", text));
        return value;
      }

      double coordinate(const std::string &text)
      {
        const std::optional<double> value = real(text);
        if (!value)
          problem(fmt::format("`{}` is not a number", text));
        return value.value_or(0.);
      }

      void add_node(const Words &words)
      {
        const auto number = label(words[0]);
        Part *const here = number ? part() : nullptr;
        if (here == nullptr)
          return;
        if (words.size() < 3)
          return problem("a node needs a number and its coordinates");
        Node &node = here->nodes[*number];
        node.line = line_number_;
        for (unsigned int d = 0; d < 3 && d + 1 < words.size(); ++d)
          node.x[d] = coordinate(words[d + 1]);
        if (keyword_.has("NSET"))
          add_member(here->node_sets, keyword_.get("NSET"), *number);
      }

      void add_member(Sets &sets, const std::string &name, const long label)
      {
        sets.emplace(upper(name), Set{name, false, {}})
            .first->second.members.emplace_back(0, label);
      }

      /** A line that ends with a comma goes on in the next one. */
      void continue_element(const std::string &line, const Words &words)
      {
        for (const std::string &word : words)
          if (!word.empty()) {
            const auto value = label(word);
            if (!value)
              return;
            pending_.push_back(*value);
          }
        if (line.back() != ',')
          close_element();
      }

      void close_element()
      {
        if (pending_.empty())
          return;
        const std::vector<long> numbers = std::move(pending_);
        pending_.clear();
        const std::string type = upper(keyword_.get("TYPE"));
        const ElementType kind = element_type(type);
        if (!kind.refusal.empty())
          return problem(
              fmt::format("element type {}: {}", type, kind.refusal));
        if (kind.dimension == 0 || kind.dimension + 1 < dimension_) {
          ++deck_.skipped[type];
          return;
        }
        if (kind.dimension > dimension_)
          return problem(fmt::format("elements of the type {} are for three "
                                     "dimensions; write `set dimension = 3`",
                                     type));
        const unsigned int corners =
            n_corners(kind.dimension, numbers.size() - 1);
        if (corners == 0)
          return problem(fmt::format("{} nodes do not make an element of the "
                                     "type {}",
                                     numbers.size() - 1, type));
        Part *const here = part();
        if (here == nullptr)
          return;
        here->elements[numbers[0]] = {
            type,
            kind.dimension,
            {numbers.begin() + 1, numbers.begin() + 1 + corners},
            line_number_,
            corners + 1 < numbers.size()};
        if (!keyword_.get("ELSET").empty())
          add_member(here->element_sets, keyword_.get("ELSET"), numbers[0]);
      }

      /** The instance that a line of the assembly speaks of; 0: none. */
      std::size_t instance_of(const std::string &name)
      {
        for (std::size_t i = 1; i < deck_.instances.size(); ++i)
          if (upper(deck_.instances[i].name) == upper(name))
            return i;
        problem(fmt::format("there is no instance `{}` above", name));
        return 0;
      }

      /**
       * What a word of a set or surface means: a label, the name of a set, or
       * one of these behind the name of an instance and a dot.
       */
      std::vector<Member> members(const std::string &given,
                                  const bool is_of_nodes)
      {
        Scope *here = scope();
        std::size_t instance = 0;
        std::string word = unquoted(given);
        if (here == &deck_.assembly) {
          const std::size_t dot = word.find('.');
          if (keyword_.has("INSTANCE"))
            instance = instance_of(keyword_.get("INSTANCE"));
          else if (dot != std::string::npos) {
            instance = instance_of(word.substr(0, dot));
            word.erase(0, dot + 1);
          }
          if (instance > 0)
            here = &deck_.parts[deck_.instances[instance].part];
        }
        if (here == nullptr || !problems_.empty())
          return {};
        if (begins_with_digit(word)) {
          return {{instance, label(word).value_or(0)}};
        }
        const Sets &sets = is_of_nodes ? here->node_sets : here->element_sets;
        const auto found = sets.find(upper(word));
        if (found == sets.end()) {
          problem(fmt::format("there is no {} set `{}` above",
                              is_of_nodes ? "node" : "element", given));
          return {};
        }
        std::vector<Member> result = found->second.members;
        if (instance > 0)
          for (Member &member : result)
            member.first = instance;
        return result;
      }

      void add_to_set(const Words &words)
      {
        const bool is_of_nodes = keyword_.is("*NSET");
        Scope *const here = scope();
        if (here == nullptr)
          return;
        Sets &sets = is_of_nodes ? here->node_sets : here->element_sets;
        Set &set = sets.at(upper(keyword_.get(is_of_nodes ? "NSET" : "ELSET")));
        if (keyword_.has("GENERATE"))
          return generate(words, is_of_nodes, set);
        for (const std::string &word : words)
          if (!word.empty()) {
            const std::vector<Member> more = members(word, is_of_nodes);
            set.members.insert(set.members.end(), more.begin(), more.end());
            if (more.size() > 1)
              tidy(set); // sets of sets of themselves would grow for ever
          }
      }

      /** Only of labels that there are: the last one may be anything. */
      void generate(const Words &words, const bool is_of_nodes, Set &set)
      {
        const auto from = label(words[0]);
        const auto to = words.size() > 1 ? label(words[1]) : from;
        const auto by = words.size() > 2 && !words[2].empty()
                            ? label(words[2])
                            : std::optional<long>(1);
        if (!from || !to || !by)
          return;
        if (*by <= 0)
          return problem("GENERATE takes first, last and a positive step");
        std::size_t instance = 0;
        const Part *of = nullptr;
        if (in_assembly_ && instance_ == 0) {
          if (!keyword_.has("INSTANCE"))
            return problem("GENERATE in the assembly needs INSTANCE=");
          instance = instance_of(keyword_.get("INSTANCE"));
          of = &deck_.parts[deck_.instances[instance].part];
        } else
          of = part();
        if (of == nullptr || !problems_.empty())
          return;
        const auto collect = [&](const auto &labelled) {
          for (auto at = labelled.lower_bound(*from);
               at != labelled.end() && at->first <= *to; ++at)
            // labels are of any size, their difference may be none
            if (((unsigned long)(at->first) - (unsigned long)(*from)) %
                    (unsigned long)(*by) ==
                0)
              set.members.emplace_back(instance, at->first);
        };
        if (is_of_nodes)
          collect(of->nodes);
        else
          collect(of->elements);
      }

      void add_to_surface(const Words &words)
      {
        Scope *const here = scope();
        if (here == nullptr)
          return;
        if (upper(keyword_.get("TYPE")) == "NODE") {
          const std::vector<Member> more = members(words[0], true);
          Set &set = here->node_sets.at(upper(keyword_.get("NAME")));
          set.members.insert(set.members.end(), more.begin(), more.end());
          return;
        }
        const std::string side = words.size() > 1 ? upper(words[1]) : "";
        if (side.empty())
          return problem("a face of a *SURFACE is written as: set or element, "
                         "S1");
        for (const Member &element : members(words[0], false))
          here->surfaces.back().sides.push_back({element, side, line_number_});
      }

      /** First a translation, then an axis by two points, and an angle. */
      void place_instance(const Words &words)
      {
        Instance &instance = deck_.instances[instance_];
        const auto number = [&](const std::size_t i) {
          return i < words.size() ? coordinate(words[i]) : 0.;
        };
        if (n_lines_ == 1)
          for (unsigned int d = 0; d < 3; ++d)
            instance.translation[d] = number(d);
        else if (n_lines_ == 2 && words.size() >= 7) {
          for (unsigned int d = 0; d < 3; ++d) {
            instance.axis_begin[d] = number(d);
            instance.axis_end[d] = number(3 + d);
          }
          instance.angle = number(6);
        } else
          problem("an instance has a line of its translation and one of seven "
                  "numbers of its rotation: two points and an angle");
      }

      /** Part 0 is there for decks without parts, and instance 0 is of it. */
      void finish_parts()
      {
        if (deck_.parts.size() > 1 && !deck_.parts[0].nodes.empty() &&
            problems_.empty())
          problems_.push_back("there are nodes outside of the parts; put all "
                              "of them into parts or none");
        // parts that no assembly has put anywhere are where they are
        if (deck_.instances.size() == 1)
          for (std::size_t p = 1; p < deck_.parts.size(); ++p) {
            Instance instance;
            instance.name = deck_.parts[p].name;
            instance.part = p;
            deck_.instances.push_back(instance);
          }
      }

      const unsigned int dimension_;
      std::vector<std::string> &problems_;
      Deck deck_;
      unsigned int line_number_ = 0, n_lines_ = 0; ///< of file, of block
      Keyword keyword_;
      bool takes_surface_ = false;
      bool in_assembly_ = false;
      /// 0: none; `instance_` with lines of its own is `meshed_instance_`
      std::size_t part_ = 0, instance_ = 0, meshed_instance_ = 0;
      std::vector<long> pending_; ///< numbers of an element so far
    };
  } // namespace

  Deck read_deck(std::istream &in, const unsigned int dimension,
                 std::vector<std::string> &problems)
  {
    return DeckReader(dimension, problems).read(in);
  }
} // namespace nsfd::abaqus
