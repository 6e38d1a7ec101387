#include "abaqus_deck.h"
#include "abaqus_elements.h"
#include "abaqus_words.h"
#include "mesh_file.h"
#include "node_sets.h"

#include "nsfd/core/space.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>

namespace nsfd
{
  namespace abaqus
  {
    namespace
    {
      using namespace space;

      /** Translated, then turned about the axis through two points. */
      class Placement
      {
      public:
        explicit Placement(const Instance &instance)
            : translation_(instance.translation), origin_(instance.axis_begin)
        {
          const double angle = instance.angle / 180. * std::acos(-1.);
          const Vec3 along = instance.axis_end - instance.axis_begin;
          const double length = norm(along);
          is_turned_ = instance.angle != 0. && length > 0.;
          if (!is_turned_)
            return;
          axis_ = (1. / length) * along;
          cosine_ = std::cos(angle);
          sine_ = std::sin(angle);
        }

        Vec3 operator()(const Vec3 &place) const
        {
          const Vec3 x = place + translation_;
          if (!is_turned_)
            return x;
          // Rodrigues' formula
          const Vec3 r = x - origin_;
          return origin_ + cosine_ * r + sine_ * cross(axis_, r) +
                 ((1. - cosine_) * dot(axis_, r)) * axis_;
        }

      private:
        Vec3 translation_, origin_, axis_{};
        bool is_turned_ = false;
        double cosine_ = 1., sine_ = 0.;
      };

      struct Placed {
        const Element *element;
        std::vector<unsigned int> vertices, groups;
      };

      /** The parts of a deck at their places, and its sets as groups. */
      class Assembly
      {
      public:
        Assembly(const Deck &deck, const unsigned int dimension,
                 std::vector<std::string> &problems)
            : deck_(deck), problems_(problems), nodes_(deck.instances.size()),
              elements_(deck.instances.size())
        {
          mesh_.dimension = dimension;
        }

        NamedMesh build()
        {
          for (std::size_t i = 0; i < deck_.instances.size(); ++i)
            place(i);
          for (std::size_t i = 0; i < deck_.instances.size(); ++i)
            add_sets(deck_.parts[deck_.instances[i].part], i);
          add_sets(deck_.assembly, 0);
          if (!problems_.empty())
            return {};
          for (const auto &of_instance : elements_)
            for (const auto &[label, placed] : of_instance)
              add(label, placed);
          for (const auto &[corners, group] : surface_faces_)
            mesh_.faces.add(row_by_row(corners, mesh_.dimension - 1),
                            mesh_.set_of({group}));
          add_node_sets(mesh_, node_sets_);
          add_notes();
          return std::move(mesh_);
        }

      private:
        void problem(const unsigned int line, const std::string &message)
        {
          if (problems_.empty())
            problems_.push_back(fmt::format("line {}: {}", line, message));
        }

        /** With one instance, sets have the names that the part gives them. */
        bool has_many() const { return deck_.instances.size() > 2; }

        void place(const std::size_t i)
        {
          const Instance &instance = deck_.instances[i];
          const Part &part = deck_.parts[instance.part];
          const Placement at(instance);
          for (const auto &[label, node] : part.nodes) {
            nodes_[i].emplace_hint(nodes_[i].end(), label,
                                   unsigned(mesh_.n_vertices()));
            const Vec3 x = at(node.x);
            mesh_.coordinates.insert(mesh_.coordinates.end(), x.begin(),
                                     x.end());
          }
          for (const auto &[label, element] : part.elements) {
            Placed placed{&element, {}, {}};
            for (const long corner : element.corners) {
              const auto node = nodes_[i].find(corner);
              if (node == nodes_[i].end())
                return problem(element.line,
                               fmt::format("there is no node {}", corner));
              placed.vertices.push_back(node->second);
            }
            if (has_many() && element.dimension == mesh_.dimension)
              placed.groups.push_back(
                  find_or_add_group(mesh_, element.dimension, instance.name));
            elements_[i].emplace_hint(elements_[i].end(), label,
                                      std::move(placed));
          }
        }

        void add_sets(const Scope &scope, const std::size_t instance)
        {
          const bool is_assembly = &scope == &deck_.assembly;
          const std::string before = !is_assembly && has_many()
                                         ? deck_.instances[instance].name + "."
                                         : "";
          const auto of = [&](const Member &member) {
            return is_assembly ? member.first : instance;
          };
          for (const auto &[key, set] : scope.element_sets)
            if (!set.is_internal) // what is left of a surface or a load
              add_set(before + set.name, set, of);
          for (const Surface &surface : scope.surfaces)
            for (const Surface::Side &side : surface.sides)
              add_side(before + surface.name, side, of(side.element));
          for (const auto &[key, set] : scope.node_sets) {
            if (set.is_internal)
              continue;
            node_sets_.push_back({before + set.name, {}});
            for (const Member &member : set.members) {
              const auto found = nodes_[of(member)].find(member.second);
              if (found == nodes_[of(member)].end())
                ++n_missing_;
              else
                node_sets_.back().vertices.push_back(found->second);
            }
          }
        }

        template <typename Instance>
        void add_set(const std::string &name, const Set &set,
                     const Instance &instance_of)
        {
          std::map<unsigned int, unsigned int> group; // by dimension
          for (const Member &member : set.members) {
            auto &elements = elements_[instance_of(member)];
            const auto found = elements.find(member.second);
            if (found == elements.end()) {
              ++n_missing_;
              continue;
            }
            const unsigned int dimension = found->second.element->dimension;
            if (group.count(dimension) == 0)
              group[dimension] = find_or_add_group(mesh_, dimension, name);
            found->second.groups.push_back(group[dimension]);
          }
        }

        void add_side(const std::string &name, const Surface::Side &side,
                      const std::size_t instance)
        {
          const auto found = elements_[instance].find(side.element.second);
          if (found == elements_[instance].end()) {
            ++n_missing_;
            return;
          }
          Placed &placed = found->second;
          const unsigned int dimension = placed.element->dimension;
          const auto group = [&] {
            return find_or_add_group(mesh_, mesh_.dimension - 1, name);
          };
          if (dimension + 1 == mesh_.dimension) {
            if (side.side == "SPOS" || side.side == "SNEG")
              placed.groups.push_back(group());
            return;
          }
          const auto number = side.side[0] == 'S' ? integer(side.side.substr(1))
                                                  : std::optional<long>();
          if (!number)
            return problem(side.line,
                           fmt::format("`{}` is not a face; a face of a "
                                       "*SURFACE is written as: set or "
                                       "element, S1",
                                       side.side));
          std::vector<unsigned int> corners;
          if (*number > 0 && *number <= 6)
            for (const unsigned int k :
                 face_of(dimension, unsigned(placed.vertices.size()),
                         unsigned(*number)))
              corners.push_back(placed.vertices[k]);
          if (corners.empty())
            return problem(side.line,
                           fmt::format("element {} has no face {}",
                                       side.element.second, side.side));
          surface_faces_.emplace_back(corners, group());
        }

        void add(const long label, const Placed &placed)
        {
          const auto corners =
              row_by_row(placed.vertices, placed.element->dimension);
          const auto [entry, is_new] = set_of_.emplace(placed.groups, 0);
          if (is_new)
            entry->second = mesh_.set_of(placed.groups);
          const unsigned int set = entry->second;
          if (placed.element->dimension == mesh_.dimension) {
            mesh_.cells.add(corners, set, std::size_t(label));
            n_curved_ += placed.element->is_curved;
            if (element_type(placed.element->type).is_structural)
              ++n_taken_[placed.element->type];
          } else
            mesh_.faces.add(corners, set);
        }

        void add_notes()
        {
          std::vector<std::string> &notes = mesh_.notes;
          for (const auto &[type, n] : deck_.skipped)
            notes.push_back(fmt::format("{} element{} of the type {} are no "
                                        "cells and were left out",
                                        n, n == 1 ? "" : "s", type));
          for (const auto &[type, n] : n_taken_)
            notes.push_back(fmt::format("{} elements of the type {} were taken "
                                        "for plane cells of their corners",
                                        n, type));
          note_straight_sides(mesh_, n_curved_);
          if (n_missing_ > 0)
            notes.push_back(fmt::format("{} entries of sets and surfaces name "
                                        "nodes or elements that are not there",
                                        n_missing_));
          if (mesh_.cells.size() > 0 || mesh_.faces.size() == 0)
            return;
          std::set<std::string> types;
          for (const auto &of_instance : elements_)
            for (const auto &[label, placed] : of_instance)
              types.insert(placed.element->type);
          problems_.push_back(fmt::format(
              "it has shells and faces, but no cells of {} dimensions: element "
              "type{} {}; write `set dimension = 2` if it lies in a plane, or "
              "mesh the body with C3D4, C3D6 or C3D8",
              mesh_.dimension, types.size() == 1 ? "" : "s",
              fmt::join(types, ", ")));
        }

        const Deck &deck_;
        std::vector<std::string> &problems_;
        NamedMesh mesh_;
        /// by instance and label: vertices and cells
        std::vector<std::map<long, unsigned int>> nodes_;
        std::vector<std::map<long, Placed>> elements_;
        std::vector<std::pair<std::vector<unsigned int>, unsigned int>>
            surface_faces_; ///< corners as Abaqus has them, group
        std::vector<NodeSet> node_sets_;
        std::map<std::string, std::size_t> n_taken_; ///< shells as plane cells
        /// sets of groups that have been looked up
        std::map<std::vector<unsigned int>, unsigned int> set_of_;
        std::size_t n_missing_ = 0, n_curved_ = 0;
      };
    } // namespace
  }   // namespace abaqus

  NamedMesh read_abaqus(const std::string &file, const unsigned int dimension,
                        std::vector<std::string> &problems)
  {
    std::ifstream in(file);
    const abaqus::Deck deck = abaqus::read_deck(in, dimension, problems);
    if (!problems.empty())
      return {};
    return abaqus::Assembly(deck, dimension, problems).build();
  }
} // namespace nsfd
