#include "mesh_file.h"

#include "cell_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

namespace nsfd
{
  namespace
  {
    std::string trimmed(const std::string &text)
    {
      const auto first = text.find_first_not_of(" \t\r");
      if (first == std::string::npos)
        return "";
      return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
    }

    std::string upper(std::string text)
    {
      std::transform(text.begin(), text.end(), text.begin(),
                     [](const unsigned char c) { return std::toupper(c); });
      return text;
    }

    std::vector<std::string> fields(const std::string &line)
    {
      std::vector<std::string> result;
      std::istringstream in(line);
      std::string field;
      while (std::getline(in, field, ','))
        result.push_back(trimmed(field));
      return result;
    }

    /** 2 for membranes, shells and plane elements, 0 for what is no cell. */
    unsigned int dimension_of(const std::string &type)
    {
      const auto begins = [&](const char *word) {
        return type.rfind(word, 0) == 0;
      };
      for (const char *word : {"C3D", "DC3D"})
        if (begins(word))
          return 3;
      for (const char *word : {"CPS", "CPE", "CGPE", "DC2D", "M3D", "SFM3D",
                               "STRI", "R3D", "S3", "S4", "S6", "S8", "S9"})
        if (begins(word))
          return 2;
      for (const char *word : {"T2D", "T3D", "B2", "B3", "R2D"})
        if (begins(word))
          return 1;
      return 0;
    }

    /** Middle nodes come after the corners. */
    unsigned int n_corners(const unsigned int dimension,
                           const std::size_t n_nodes)
    {
      const std::map<std::pair<unsigned int, std::size_t>, unsigned int> known =
          {{{1, 2}, 2},  {{1, 3}, 2}, {{2, 3}, 3},  {{2, 6}, 3},  {{2, 4}, 4},
           {{2, 8}, 4},  {{2, 9}, 4}, {{3, 4}, 4},  {{3, 10}, 4}, {{3, 6}, 6},
           {{3, 15}, 6}, {{3, 8}, 8}, {{3, 20}, 8}, {{3, 27}, 8}};
      const auto found = known.find({dimension, n_nodes});
      return found == known.end() ? 0 : found->second;
    }

    /** Faces S1, S2, ... as Abaqus numbers them, in its order of corners. */
    std::vector<unsigned int> face_of(const unsigned int dimension,
                                      const unsigned int corners,
                                      const unsigned int face)
    {
      using Faces = std::vector<std::vector<unsigned int>>;
      const std::map<std::pair<unsigned int, unsigned int>, Faces> known = {
          {{2, 3}, {{0, 1}, {1, 2}, {2, 0}}},
          {{2, 4}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
          {{3, 4}, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}},
          {{3, 6},
           {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}},
          {{3, 8},
           {{0, 1, 2, 3},
            {4, 7, 6, 5},
            {0, 4, 5, 1},
            {1, 5, 6, 2},
            {2, 6, 7, 3},
            {3, 7, 4, 0}}}};
      const auto found = known.find({dimension, corners});
      if (found == known.end() || face == 0 || face > found->second.size())
        return {};
      return found->second[face - 1];
    }

    /** From going round to going row by row. */
    std::vector<unsigned int> row_by_row(std::vector<unsigned int> corners,
                                         const unsigned int dimension)
    {
      if (corners.size() == 4 && dimension == 2)
        std::swap(corners[2], corners[3]);
      if (corners.size() == 8) {
        std::swap(corners[2], corners[3]);
        std::swap(corners[6], corners[7]);
      }
      return corners;
    }

    struct Element {
      unsigned int dimension;
      std::vector<unsigned int> corners; ///< vertices, in Abaqus's order
      std::vector<unsigned int> groups;
    };

    class Deck
    {
    public:
      Deck(const unsigned int dimension, std::vector<std::string> &problems)
          : problems_(problems)
      {
        mesh_.dimension = dimension;
      }

      void read(std::istream &in)
      {
        std::string line;
        while (std::getline(in, line) && problems_.empty()) {
          ++line_number_;
          line = trimmed(line);
          if (line.empty() || line.rfind("**", 0) == 0)
            continue;
          if (line[0] == '*')
            open_keyword(line);
          else if (keyword_ == "*NODE")
            add_node(fields(line));
          else if (keyword_ == "*ELEMENT")
            continue_element(line);
          else if (keyword_ == "*ELSET")
            add_to_set(fields(line));
          else if (keyword_ == "*SURFACE")
            add_to_surface(fields(line));
        }
      }

      NamedMesh finish()
      {
        if (!problems_.empty())
          return {};
        for (auto &[label, element] : elements_)
          add(label, element);
        for (const auto &[corners, groups] : surface_faces_)
          mesh_.faces.add(row_by_row(corners, mesh_.dimension - 1),
                          mesh_.set_of(groups));
        if (!unknown_types_.empty()) {
          std::string list;
          for (const std::string &type : unknown_types_)
            list += (list.empty() ? "" : ", ") + type;
          mesh_.notes.push_back("elements of the type " + list +
                                " are no cells and were left out");
        }
        return std::move(mesh_);
      }

    private:
      void problem(const std::string &message)
      {
        problems_.push_back(fmt::format("line {}: {}", line_number_, message));
      }

      /** Value of a parameter of the present keyword, as it is written. */
      std::string parameter(const std::string &name) const
      {
        const auto found = parameters_.find(name);
        return found == parameters_.end() ? "" : found->second;
      }

      void open_keyword(const std::string &line)
      {
        const std::vector<std::string> words = fields(line);
        keyword_ = upper(words[0]);
        parameters_.clear();
        pending_.clear();
        for (std::size_t i = 1; i < words.size(); ++i) {
          const std::size_t equals = words[i].find('=');
          parameters_[upper(trimmed(words[i].substr(0, equals)))] =
              equals == std::string::npos
                  ? ""
                  : trimmed(words[i].substr(equals + 1));
        }
        if (keyword_ == "*INSTANCE" && ++n_instances_ > 1)
          problem("a second *INSTANCE; only one can be read: mesh it as one "
                  "part");
      }

      std::optional<long> integer(const std::string &text)
      {
        try {
          std::size_t end = 0;
          const long value = std::stol(text, &end);
          if (end == text.size())
            return value;
        } catch (const std::exception &) {
        }
        problem(fmt::format("`{}` is not an integer", text));
        return {};
      }

      void add_node(const std::vector<std::string> &words)
      {
        const auto label = integer(words[0]);
        if (!label)
          return;
        if (words.size() < 3)
          return problem("a node needs a number and its coordinates");
        node_[*label] = unsigned(mesh_.n_vertices());
        for (unsigned int d = 0; d < 3; ++d)
          try {
            mesh_.coordinates.push_back(d + 1 < words.size() &&
                                                !words[d + 1].empty()
                                            ? std::stod(words[d + 1])
                                            : 0.);
          } catch (const std::exception &) {
            return problem(
                fmt::format("`{}` is not a coordinate", words[d + 1]));
          }
      }

      /** A line that ends with a comma goes on in the next one. */
      void continue_element(const std::string &line)
      {
        for (const std::string &word : fields(line))
          if (!word.empty()) {
            const auto value = integer(word);
            if (!value)
              return;
            pending_.push_back(*value);
          }
        if (line.back() != ',') {
          add_element();
          pending_.clear();
        }
      }

      void add_element()
      {
        const std::string type = upper(parameter("TYPE"));
        const unsigned int dimension = dimension_of(type);
        const unsigned int corners =
            n_corners(dimension, pending_.empty() ? 0 : pending_.size() - 1);
        if (dimension == 0 || dimension + 1 < mesh_.dimension) {
          unknown_types_.insert(type);
          return;
        }
        if (dimension > mesh_.dimension)
          return problem(fmt::format("elements of the type {} are for three "
                                     "dimensions; write `set dimension = 3`",
                                     type));
        if (corners == 0)
          return problem(fmt::format("{} nodes do not make an element of the "
                                     "type {}",
                                     pending_.size(), type));
        Element &element = elements_[pending_[0]];
        element = {dimension, {}, {}};
        for (unsigned int i = 1; i <= corners; ++i) {
          const auto node = node_.find(pending_[i]);
          if (node == node_.end())
            return problem(fmt::format("there is no node {}", pending_[i]));
          element.corners.push_back(node->second);
        }
        const std::string set = parameter("ELSET");
        if (!set.empty())
          put_into(element, set);
        members_[upper(set)].push_back(pending_[0]);
      }

      unsigned int group(const unsigned int dimension, const std::string &name)
      {
        const auto [entry, is_new] = group_.emplace(
            std::pair(dimension, upper(name)), unsigned(mesh_.groups.size()));
        if (is_new)
          mesh_.groups.push_back(
              {dimension, int(mesh_.groups.size()) + 1, name, 0, 0});
        return entry->second;
      }

      void put_into(Element &element, const std::string &set)
      {
        element.groups.push_back(group(element.dimension, set));
      }

      void put_into(const long label, const std::string &set)
      {
        const auto element = elements_.find(label);
        if (element != elements_.end())
          put_into(element->second, set);
        members_[upper(set)].push_back(label);
      }

      void add_to_set(const std::vector<std::string> &words)
      {
        const std::string name = parameter("ELSET");
        if (parameters_.count("GENERATE") != 0) {
          const auto from = integer(words[0]),
                     to = words.size() > 1 ? integer(words[1]) : from,
                     by = words.size() > 2 && !words[2].empty()
                              ? integer(words[2])
                              : std::optional<long>(1);
          if (from && to && by && *by > 0)
            for (long label = *from; label <= *to; label += *by)
              put_into(label, name);
          return;
        }
        for (const std::string &word : words) {
          if (word.empty())
            continue;
          const bool is_number =
              std::isdigit(static_cast<unsigned char>(word[0]));
          if (is_number) {
            if (const auto label = integer(word))
              put_into(*label, name);
          } else // another set
            for (const long label : std::vector<long>(members_[upper(word)]))
              put_into(label, name);
        }
      }

      void add_to_surface(const std::vector<std::string> &words)
      {
        const std::string type = upper(parameter("TYPE"));
        if (!type.empty() && type != "ELEMENT")
          return;
        const std::string side = words.size() > 1 ? upper(words[1]) : "";
        if (side.size() < 2 || side[0] != 'S' ||
            !std::isdigit(static_cast<unsigned char>(side[1])))
          return problem("a face of a *SURFACE is written as: set or element, "
                         "S1");
        const auto face = unsigned(std::stoul(side.substr(1)));
        std::vector<long> labels = members_[upper(words[0])];
        if (std::isdigit(static_cast<unsigned char>(words[0][0])))
          labels = {integer(words[0]).value_or(0)};
        if (labels.empty())
          return problem(fmt::format("there is no element set `{}`", words[0]));
        const unsigned int g = group(mesh_.dimension - 1, parameter("NAME"));
        for (const long label : labels) {
          const auto element = elements_.find(label);
          if (element == elements_.end() ||
              element->second.dimension != mesh_.dimension)
            continue;
          std::vector<unsigned int> corners;
          for (const unsigned int i :
               face_of(mesh_.dimension,
                       unsigned(element->second.corners.size()), face))
            corners.push_back(element->second.corners[i]);
          if (corners.empty())
            return problem(
                fmt::format("element {} has no face {}", label, words[1]));
          surface_faces_.emplace_back(corners, std::vector<unsigned int>{g});
        }
      }

      void add(const long label, const Element &element)
      {
        const auto corners = row_by_row(element.corners, element.dimension);
        const unsigned int set = mesh_.set_of(element.groups);
        if (element.dimension == mesh_.dimension)
          mesh_.cells.add(corners, set, std::size_t(label));
        else
          mesh_.faces.add(corners, set);
      }

      NamedMesh mesh_;
      std::vector<std::string> &problems_;
      unsigned int line_number_ = 0, n_instances_ = 0;
      std::string keyword_;
      std::map<std::string, std::string> parameters_;
      std::vector<long> pending_; ///< numbers of an element so far
      std::map<long, unsigned int> node_;
      std::map<long, Element> elements_;
      std::map<std::string, std::vector<long>> members_; ///< of element sets
      std::map<std::pair<unsigned int, std::string>, unsigned int> group_;
      std::vector<
          std::pair<std::vector<unsigned int>, std::vector<unsigned int>>>
          surface_faces_;
      std::set<std::string> unknown_types_;
    };
  } // namespace

  NamedMesh read_abaqus(const std::string &file, const unsigned int dimension,
                        std::vector<std::string> &problems)
  {
    std::ifstream in(file);
    Deck deck(dimension, problems);
    deck.read(in);
    return deck.finish();
  }
} // namespace nsfd
