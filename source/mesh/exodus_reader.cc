#include "exodus_reader.h"

#include "abaqus_elements.h"
#include "netcdf_file.h"
#include "node_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>

namespace nsfd
{
  namespace
  {
    using netcdf::BadFile;

    struct BlockType {
      unsigned int dimension = 0, n_corners = 0;
      bool is_shell = false; ///< its faces have two sides
    };

    /** Of the text that names it: `TRI3`, `QUAD`, `SHELL4`, `HEX20`. */
    BlockType block_type(std::string name, const std::size_t n_nodes)
    {
      std::transform(name.begin(), name.end(), name.begin(),
                     [](const unsigned char c) { return std::toupper(c); });
      const auto begins = [&](const char *word) {
        return name.rfind(word, 0) == 0;
      };
      const unsigned int flat =
          n_nodes == 3 || n_nodes == 6 || n_nodes == 7 ? 3 : 4;
      if (begins("TRISHELL") || begins("SHELL"))
        return {2, flat, true};
      if (begins("TRI"))
        return {2, 3, false};
      if (begins("QUAD"))
        return {2, 4, false};
      if (begins("TET"))
        return {3, 4, false};
      if (begins("HEX"))
        return {3, 8, false};
      if (begins("WEDGE"))
        return {3, 6, false};
      return {};
    }

    bool is_no_body(const std::string &name)
    {
      const std::string word = name.substr(0, 3);
      for (const char *known : {"BAR", "BEA", "TRU", "ROD", "EDG", "SPH", "CIR",
                                "POI", "NOD", "LIN", "SPR"})
        if (std::equal(word.begin(), word.end(), known, known + 3,
                       [](const char a, const char b) {
                         return std::toupper(static_cast<unsigned char>(a)) ==
                                b;
                       }))
          return true;
      return false;
    }

    /** Corners of side 1, 2, ... as Exodus numbers them, 0 on. */
    std::vector<unsigned int> side_of(const BlockType &type,
                                      const unsigned int side)
    {
      using Sides = std::vector<std::vector<unsigned int>>;
      static const std::map<std::pair<unsigned int, unsigned int>, Sides>
          known = {{{2, 3}, {{0, 1}, {1, 2}, {2, 0}}},
                   {{2, 4}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
                   {{3, 4}, {{0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 2, 1}}},
                   {{3, 6},
                    {{0, 1, 4, 3},
                     {1, 2, 5, 4},
                     {0, 3, 5, 2},
                     {0, 2, 1},
                     {3, 4, 5}}},
                   {{3, 8},
                    {{0, 1, 5, 4},
                     {1, 2, 6, 5},
                     {2, 3, 7, 6},
                     {0, 4, 7, 3},
                     {0, 3, 2, 1},
                     {4, 5, 6, 7}}}};
      const auto found = known.find({type.dimension, type.n_corners});
      if (found == known.end() || side == 0 || side > found->second.size())
        return {};
      return found->second[side - 1];
    }

    class ExodusReader
    {
    public:
      ExodusReader(netcdf::File &file, const unsigned int dimension)
          : file_(file)
      {
        mesh_.dimension = dimension;
      }

      NamedMesh read()
      {
        read_nodes();
        read_numbers();
        for (std::size_t b = 1; file_.has(fmt::format("connect{}", b)); ++b)
          read_block(b);
        if (block_begin_.empty())
          throw BadFile("this is no Exodus file: it has no variable "
                        "`connect1` of an element block");
        read_side_sets();
        read_variables();
        read_node_sets();
        add_notes();
        return std::move(mesh_);
      }

    private:
      void read_nodes()
      {
        std::vector<double> x[3];
        if (file_.has("coordx")) {
          for (unsigned int d = 0; d < 3; ++d) {
            const std::string name = fmt::format("coord{}", "xyz"[d]);
            if (file_.has(name))
              x[d] = file_.numbers(name);
            n_space_ += file_.has(name);
          }
        } else if (file_.has("coord")) { // of old files
          const std::vector<std::size_t> shape = file_.shape("coord");
          const std::vector<double> all = file_.numbers("coord");
          if (shape.size() != 2 || shape[0] == 0 || shape[0] > 3)
            throw BadFile("the variable `coord` is not one row per direction");
          n_space_ = unsigned(shape[0]);
          for (unsigned int d = 0; d < n_space_; ++d)
            x[d].assign(all.begin() + std::ptrdiff_t(d * shape[1]),
                        all.begin() + std::ptrdiff_t((d + 1) * shape[1]));
        } else
          throw BadFile("this is no Exodus file: it has no coordinates");
        for (unsigned int d = 0; d < n_space_; ++d)
          if (x[d].size() != x[0].size())
            throw BadFile("it has not as many coordinates of each direction");
        for (std::size_t v = 0; v < x[0].size(); ++v)
          for (unsigned int d = 0; d < 3; ++d)
            mesh_.coordinates.push_back(d < n_space_ ? x[d][v] : 0.);
      }

      /** What users call elements: their place, if the file says nothing. */
      void read_numbers()
      {
        for (const char *name : {"elem_num_map", "elem_map"})
          if (numbers_.empty() && file_.has(name))
            numbers_ = file_.numbers(name);
      }

      std::size_t number_of(const std::size_t element) const
      {
        const double number =
            element < numbers_.size() ? numbers_[element] : 0.;
        return number > 0. ? std::size_t(number) : element + 1;
      }

      /** By block or set: its name, or its number. */
      unsigned int add_group(const unsigned int dimension,
                             const std::string &kind, const std::size_t k)
      {
        const auto &[ids, names] = labels(kind);
        const int number =
            k < ids.size() && std::abs(ids[k]) < 2e9 ? int(ids[k]) : int(k + 1);
        const std::string name = k < names.size() ? names[k] : "";
        for (unsigned int g = 0; g < mesh_.groups.size(); ++g)
          if (mesh_.groups[g].dimension == dimension &&
              mesh_.groups[g].number == number && mesh_.groups[g].name == name)
            return g;
        mesh_.groups.push_back({dimension, number, name, 0, 0});
        return unsigned(mesh_.groups.size() - 1);
      }

      struct Labels {
        std::vector<double> ids;
        std::vector<std::string> names;
      };

      /** Of `eb`, `ss` or `ns`. */
      const Labels &labels(const std::string &kind)
      {
        const auto found = labels_.find(kind);
        if (found != labels_.end())
          return found->second;
        Labels &result = labels_[kind];
        if (file_.has(kind + "_prop1"))
          result.ids = file_.numbers(kind + "_prop1");
        if (file_.has(kind + "_names"))
          result.names = file_.texts(kind + "_names");
        return result;
      }

      void read_block(const std::size_t b)
      {
        const std::string name = fmt::format("connect{}", b);
        const std::vector<std::size_t> shape = file_.shape(name);
        const std::string type_name = file_.attribute(name, "elem_type");
        block_begin_.push_back(element_.size());
        if (shape.size() != 2)
          throw BadFile(fmt::format(
              "the variable `{}` is not one row per element", name));
        const std::size_t n = shape[0], n_nodes = shape[1];
        const BlockType type = block_type(type_name, n_nodes);
        const bool is_used =
            type.dimension + 1 >= mesh_.dimension && type.dimension > 0;
        if (type.dimension == 0 && n > 0 && !is_no_body(type_name))
          throw BadFile(fmt::format(
              "element type {} is not read; mesh with TRI, QUAD, TET, HEX or "
              "WEDGE",
              type_name.empty() ? "``" : type_name));
        if (type.dimension > mesh_.dimension && n > 0)
          throw BadFile("it is a mesh of 3 dimensions, the scene has 2; write "
                        "`set dimension = 3` at the top, or bring another "
                        "file");
        if (is_used && n_nodes < type.n_corners)
          throw BadFile(fmt::format("{} nodes do not make an element of the "
                                    "type {}",
                                    n_nodes, type_name));
        if (!is_used)
          n_left_out_ += n;
        const std::vector<double> nodes =
            is_used ? file_.numbers(name) : std::vector<double>();
        const unsigned int set =
            is_used ? mesh_.set_of({add_group(type.dimension, "eb", b - 1)})
                    : 0;
        for (std::size_t e = 0; e < n; ++e) {
          element_.push_back({type, {}});
          if (!is_used)
            continue;
          auto &corners = element_.back().corners;
          for (unsigned int i = 0; i < type.n_corners; ++i) {
            const double node = nodes[e * n_nodes + i];
            if (!(node >= 1. && node <= double(mesh_.n_vertices())))
              throw BadFile(fmt::format("element {} has a node {:g} that is "
                                        "not there",
                                        number_of(element_.size() - 1), node));
            corners.push_back(unsigned(node) - 1);
          }
          const bool is_cell = type.dimension == mesh_.dimension;
          (is_cell ? mesh_.cells : mesh_.faces)
              .add(abaqus::row_by_row(corners, type.dimension), set,
                   number_of(element_.size() - 1));
          if (is_cell)
            cell_element_.push_back(element_.size() - 1);
          n_curved_ += is_cell && n_nodes > type.n_corners;
        }
      }

      void read_side_sets()
      {
        for (std::size_t s = 1; file_.has(fmt::format("elem_ss{}", s)); ++s) {
          const std::vector<double> elements =
              file_.numbers(fmt::format("elem_ss{}", s));
          const std::vector<double> sides =
              file_.numbers(fmt::format("side_ss{}", s));
          if (elements.size() != sides.size())
            throw BadFile(fmt::format("side set {} has {} elements and {} "
                                      "sides",
                                      s, elements.size(), sides.size()));
          for (std::size_t i = 0; i < elements.size(); ++i)
            add_side(s, elements[i], sides[i]);
        }
      }

      void add_side(const std::size_t s, const double element,
                    const double side)
      {
        if (!(element >= 1. && element <= double(element_.size())))
          throw BadFile(fmt::format("side set {} has an element {:g} that is "
                                    "not there",
                                    s, element));
        const Element &of = element_[std::size_t(element) - 1];
        const BlockType &type = of.type;
        if (of.corners.empty())
          return;
        // plane elements in space are shells: sides 1 and 2 are their faces
        const bool is_shell =
            type.is_shell || (type.dimension == 2 && n_space_ == 3);
        std::vector<unsigned int> corners;
        unsigned int dimension = type.dimension - 1;
        if (is_shell && (side == 1. || side == 2.)) {
          corners = of.corners;
          dimension = 2;
        } else if (side >= 1. && side <= 8.)
          for (const unsigned int k :
               side_of(type, unsigned(side) - (is_shell ? 2 : 0)))
            corners.push_back(of.corners[k]);
        if (corners.empty())
          throw BadFile(fmt::format("side set {}: element {} has no side {:g}",
                                    s, number_of(std::size_t(element) - 1),
                                    side));
        if (dimension + 1 != mesh_.dimension)
          return;
        mesh_.faces.add(abaqus::row_by_row(corners, dimension), set_of_side(s),
                        0);
      }

      unsigned int set_of_side(const std::size_t s)
      {
        const auto [entry, is_new] = side_set_.emplace(s, 0);
        if (is_new)
          entry->second =
              mesh_.set_of({add_group(mesh_.dimension - 1, "ss", s - 1)});
        return entry->second;
      }

      void read_node_sets()
      {
        std::vector<NodeSet> sets;
        for (std::size_t s = 1; file_.has(fmt::format("node_ns{}", s)); ++s) {
          const Labels &all = labels("ns");
          std::string name = s <= all.names.size() ? all.names[s - 1] : "";
          // numbers are those of side sets
          if (name.empty())
            name =
                fmt::format("node set {:g}",
                            s <= all.ids.size() ? all.ids[s - 1] : double(s));
          sets.push_back({name, {}});
          for (const double node : file_.numbers(fmt::format("node_ns{}", s))) {
            if (!(node >= 1. && node <= double(mesh_.n_vertices())))
              throw BadFile(fmt::format("node set {} has a node {:g} that is "
                                        "not there",
                                        s, node));
            sets.back().vertices.push_back(unsigned(node) - 1);
          }
        }
        add_node_sets(mesh_, sets);
      }

      /** Element variables; blocks that have none of them have no values. */
      void read_variables()
      {
        if (!file_.has("name_elem_var"))
          return;
        const std::vector<std::string> names = file_.texts("name_elem_var");
        for (std::size_t v = 0; v < names.size(); ++v) {
          std::vector<double> values(element_.size(),
                                     std::numeric_limits<double>::quiet_NaN());
          bool has_any = false;
          for (std::size_t b = 0; b < block_begin_.size(); ++b) {
            const std::string name =
                fmt::format("vals_elem_var{}eb{}", v + 1, b + 1);
            if (!file_.has(name))
              continue;
            const std::vector<double> of_block = file_.last_numbers(name);
            const std::size_t end = b + 1 < block_begin_.size()
                                        ? block_begin_[b + 1]
                                        : element_.size();
            if (of_block.size() != end - block_begin_[b])
              throw BadFile(fmt::format("the variable `{}` has {} values for "
                                        "{} elements",
                                        name, of_block.size(),
                                        end - block_begin_[b]));
            std::copy(of_block.begin(), of_block.end(),
                      values.begin() + std::ptrdiff_t(block_begin_[b]));
            has_any = true;
          }
          if (!has_any)
            continue;
          std::vector<double> of_cells;
          for (const std::size_t element : cell_element_)
            of_cells.push_back(values[element]);
          add_field(mesh_, names[v], std::move(of_cells));
        }
      }

      void add_notes()
      {
        note_straight_sides(mesh_, n_curved_);
        if (n_left_out_ > 0)
          mesh_.notes.push_back(
              fmt::format("{} elements of lower dimension are no faces of "
                          "cells and were left out",
                          n_left_out_));
      }

      struct Element {
        BlockType type;
        std::vector<unsigned int> corners; ///< going round; empty: left out
      };

      netcdf::File &file_;
      NamedMesh mesh_;
      unsigned int n_space_ = 0;
      std::vector<double> numbers_;
      std::vector<Element> element_;
      std::vector<std::size_t> block_begin_, cell_element_;
      std::map<std::string, Labels> labels_;
      std::map<std::size_t, unsigned int> side_set_; ///< its set of groups
      std::size_t n_curved_ = 0, n_left_out_ = 0;
    };
  } // namespace

  NamedMesh read_exodus_here(const std::string &file,
                             const unsigned int dimension,
                             std::vector<std::string> &problems)
  {
    try {
      const auto opened = netcdf::open_file(file);
      return ExodusReader(*opened, dimension).read();
    } catch (const BadFile &bad) {
      problems.emplace_back(bad.what());
    } catch (const std::bad_alloc &) {
      problems.emplace_back("it needs more memory than there is");
    }
    return {};
  }
} // namespace nsfd
