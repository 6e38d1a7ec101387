#include "neper_sections.h"

#include "node_sets.h"
#include "nsfd/core/space.h"

#include <fmt/format.h>

#include <cmath>
#include <istream>
#include <limits>
#include <map>
#include <sstream>

namespace nsfd
{
  namespace
  {
    using namespace space;

    constexpr double degree = 3.14159265358979323846 / 180.;

    /** Coordinates in the crystal of a vector of the scene: its rows are the
        axes of the crystal. Of a rotation of these by @p q. */
    Mat3 to_crystal(const Quaternion &q)
    {
      const double w = q[0], x = q[1], y = q[2], z = q[3];
      return {{{{w * w + x * x - y * y - z * z, 2. * (x * y + w * z),
                 2. * (x * z - w * y)}},
               {{2. * (x * y - w * z), w * w - x * x + y * y - z * z,
                 2. * (y * z + w * x)}},
               {{2. * (x * z + w * y), 2. * (y * z - w * x),
                 w * w - x * x - y * y + z * z}}}};
    }

    Mat3 to_crystal(const double phi_1, const double phi, const double phi_2)
    {
      // about axis 3, the new axis 1, the new axis 3
      const double c1 = std::cos(phi_1 * degree), s1 = std::sin(phi_1 * degree),
                   c = std::cos(phi * degree), s = std::sin(phi * degree),
                   c2 = std::cos(phi_2 * degree), s2 = std::sin(phi_2 * degree);
      return {{{{c1 * c2 - s1 * c * s2, s1 * c2 + c1 * c * s2, s * s2}},
               {{-c1 * s2 - s1 * c * c2, -s1 * s2 + c1 * c * c2, s * c2}},
               {{s1 * s, -c1 * s, c}}}};
    }

    std::array<double, 3> angles_of(const Mat3 &g)
    {
      const double sine = std::hypot(g[2][0], g[2][1]);
      // below it the two rotations about axis 3 are one
      constexpr double nothing = 1e-12;
      if (sine < nothing)
        return {{std::atan2(g[0][1], g[0][0]) / degree,
                 g[2][2] > 0. ? 0. : 180., 0.}};
      return {{std::atan2(g[2][0], -g[2][1]) / degree,
               std::atan2(sine, g[2][2]) / degree,
               std::atan2(g[0][2], g[1][2]) / degree}};
    }

    Quaternion normed(const Quaternion &q)
    {
      double length = 0.;
      for (const double component : q)
        length += component * component;
      length = std::sqrt(length);
      return {{q[0] / length, q[1] / length, q[2] / length, q[3] / length}};
    }
  } // namespace

  bool bunge_angles(const std::string &name, const std::vector<double> &values,
                    std::array<double, 3> &angles)
  {
    const std::string kind = name.substr(0, name.find(':'));
    const auto &v = values;
    Mat3 g{};
    if (kind == "rodrigues" && v.size() == 3)
      g = to_crystal(normed({{1., v[0], v[1], v[2]}}));
    else if (kind == "quaternion" && v.size() == 4)
      g = to_crystal(normed({{v[0], v[1], v[2], v[3]}}));
    else if (kind == "axis-angle" && v.size() == 4) {
      const double length = norm({{v[0], v[1], v[2]}});
      const double half = .5 * v[3] * degree, s = std::sin(half) / length;
      g = to_crystal({{std::cos(half), s * v[0], s * v[1], s * v[2]}});
    } else if (kind == "rotmat" && v.size() == 9)
      for (unsigned int i = 0; i < 9; ++i)
        g[i / 3][i % 3] = v[i];
    else if (kind == "euler-bunge" && v.size() == 3)
      g = to_crystal(v[0], v[1], v[2]);
    else if (kind == "euler-kocks" && v.size() == 3)
      g = to_crystal(v[0] + 90., v[1], 90. - v[2]);
    else if (kind == "euler-roe" && v.size() == 3)
      g = to_crystal(v[0] + 90., v[1], v[2] - 90.);
    else
      return false;
    if (name == kind + ":active")
      g = transposed(g);
    angles = angles_of(g);
    return true;
  }

  namespace
  {
    class NeperReader
    {
    public:
      NeperReader(std::istream &in, NamedMesh &mesh,
                  const std::function<unsigned int(std::size_t)> &vertex_of,
                  std::vector<std::string> &problems)
          : in_(in), mesh_(mesh), vertex_of_(vertex_of), problems_(problems)
      {
      }

      void read()
      {
        std::string line;
        while (problems_.empty() && std::getline(in_, line)) {
          while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
            line.pop_back();
          section_ = line;
          if (line == "$NSets")
            read_node_sets();
          else if (line == "$Fasets")
            read_face_sets();
          else if (line == "$Periodicity")
            read_periodicity();
          else if (line == "$ElsetOrientations")
            read_orientations(of_set_);
          else if (line == "$ElementOrientations")
            read_orientations(of_element_);
          else if (line == "$Groups")
            read_groups();
        }
        if (!problems_.empty())
          return;
        add_periodic_sides();
        add_node_sets(mesh_, sets_);
        add_orientations();
        add_group_field();
      }

    private:
      void fail(const std::string &what)
      {
        problems_.push_back(fmt::format("section {}: {}", section_, what));
      }

      /** The next number; 0 and a problem if there is none. */
      template <typename Number>
      Number next(const char *what)
      {
        Number value{};
        if (!(in_ >> value) && problems_.empty())
          fail(fmt::format("{} is missing", what));
        return value;
      }

      bool goes_on() const { return problems_.empty() && bool(in_); }

      void add_node(NodeSet &set, const long node)
      {
        const unsigned int vertex =
            node > 0 ? vertex_of_(std::size_t(node))
                     : std::numeric_limits<unsigned int>::max();
        if (vertex < mesh_.n_vertices())
          set.vertices.push_back(vertex);
        else if (problems_.empty())
          fail(fmt::format("there is no node {}", node));
      }

      void read_node_sets()
      {
        const auto n = next<long>("the number of sets");
        for (long s = 0; s < n && goes_on(); ++s) {
          NodeSet set{next<std::string>("the name of a set"), {}};
          const auto n_nodes = next<long>("the number of nodes of a set");
          for (long i = 0; i < n_nodes && goes_on(); ++i)
            add_node(set, next<long>("a node"));
          sets_.push_back(set);
        }
      }

      /** Lines of an element and the nodes of its face, of any order. */
      void read_face_sets()
      {
        const auto n = next<long>("the number of sets");
        for (long s = 0; s < n && goes_on(); ++s) {
          NodeSet set{next<std::string>("the name of a set"), {}};
          const auto n_faces = next<long>("the number of faces of a set");
          std::string line;
          std::getline(in_, line);
          for (long f = 0; f < n_faces && goes_on(); ++f) {
            if (!std::getline(in_, line))
              return fail("a face is missing");
            std::istringstream words(line);
            long element = 0, node = 0;
            words >> element;
            while (words >> node)
              add_node(set, node);
          }
          sets_.push_back(set);
        }
      }

      void read_periodicity()
      {
        const auto n = next<long>("the number of pairs");
        for (long i = 0; i < n && goes_on(); ++i) {
          const auto secondary = next<long>("a node"),
                     primary = next<long>("a node");
          Shift shift{};
          for (int &component : shift)
            component = next<int>("a shift");
          copies_[primary][shift] = secondary;
          copies_[primary][Shift{}] = primary;
        }
      }

      /**
       * A node with a copy one period further on is on the lower side, that
       * copy on the upper one. Corners have copies in several directions.
       */
      void add_periodic_sides()
      {
        section_ = "$Periodicity";
        for (unsigned int d = 0; d < mesh_.dimension; ++d) {
          NodeSet lower{fmt::format("periodic {}0", "xyz"[d]), {}},
              upper{fmt::format("periodic {}1", "xyz"[d]), {}};
          for (const auto &[primary, nodes] : copies_)
            for (const auto &[shift, node] : nodes) {
              Shift next_shift = shift;
              if (next_shift[d] == std::numeric_limits<int>::max())
                continue;
              ++next_shift[d];
              const auto other = nodes.find(next_shift);
              if (other == nodes.end())
                continue;
              add_node(lower, node);
              add_node(upper, other->second);
            }
          if (lower.vertices.empty())
            continue;
          sets_.push_back(lower);
          sets_.push_back(upper);
        }
      }

      using Angles = std::map<long, std::array<double, 3>>;

      void read_orientations(Angles &angles)
      {
        const auto n = next<long>("the number of orientations");
        const auto descriptor = next<std::string>("the descriptor");
        std::string line;
        std::getline(in_, line);
        for (long i = 0; i < n && goes_on(); ++i) {
          if (!std::getline(in_, line))
            return fail("an orientation is missing");
          std::istringstream words(line);
          long id = 0;
          words >> id;
          std::vector<double> values;
          for (double value = 0.; words >> value;)
            values.push_back(value);
          if (!bunge_angles(descriptor, values, angles[id]))
            return fail(fmt::format(
                "orientation {} has {} values of the descriptor `{}`; Neper "
                "writes 3 of rodrigues, euler-bunge, euler-kocks or "
                "euler-roe, 4 of quaternion or axis-angle, 9 of rotmat",
                id, values.size(), descriptor));
        }
      }

      void read_groups()
      {
        if (next<std::string>("what is grouped") != "elset")
          return;
        const auto n = next<long>("the number of elsets");
        for (long i = 0; i < n && goes_on(); ++i) {
          const auto elset = next<long>("an elset");
          group_[elset] = next<double>("a group");
        }
      }

      /** The elset of a cell is its group of cells. */
      long elset_of(const std::size_t cell) const
      {
        for (const unsigned int g : mesh_.sets[mesh_.cells.set[cell]])
          if (mesh_.groups[g].dimension == mesh_.dimension)
            return mesh_.groups[g].number;
        return 0;
      }

      void add_orientations()
      {
        if (of_set_.empty() && of_element_.empty())
          return;
        auto &data = mesh_.element_data["orientation"];
        for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
          const std::size_t number = mesh_.cells.numbers[c];
          const auto own = of_element_.find(long(number));
          const auto of_set = of_set_.find(elset_of(c));
          if (own != of_element_.end())
            data[number] = {own->second.begin(), own->second.end()};
          else if (of_set != of_set_.end())
            data[number] = {of_set->second.begin(), of_set->second.end()};
        }
      }

      void add_group_field()
      {
        if (group_.empty())
          return;
        std::vector<double> values;
        for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
          const auto group = group_.find(elset_of(c));
          values.push_back(group != group_.end()
                               ? group->second
                               : std::numeric_limits<double>::quiet_NaN());
        }
        add_field(mesh_, "group", std::move(values));
      }

      using Shift = std::array<int, 3>; ///< periods

      std::istream &in_;
      NamedMesh &mesh_;
      const std::function<unsigned int(std::size_t)> &vertex_of_;
      std::vector<std::string> &problems_;
      std::string section_;
      std::vector<NodeSet> sets_;
      std::map<long, std::map<Shift, long>> copies_; ///< by their primary node
      Angles of_set_, of_element_;
      std::map<long, double> group_; ///< of elsets
    };
  } // namespace

  void
  add_neper_sections(std::istream &in, NamedMesh &mesh,
                     const std::function<unsigned int(std::size_t)> &vertex_of,
                     std::vector<std::string> &problems)
  {
    NeperReader(in, mesh, vertex_of, problems).read();
  }
} // namespace nsfd
