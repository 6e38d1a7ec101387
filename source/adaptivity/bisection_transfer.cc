#include "bisection_transfer.h"

#include "linear_triangle.h"

#include "discretization/discretization.h"
#include "state/point_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace nsfd
{
  namespace
  {
    /// see FrontViscosity::serialize()
    constexpr const char *front_name = "front_viscosity";
    enum Front { tension, rate, next_viscosity, viscosity };
  } // namespace

  /** By name. */
  class BisectionTransfer::Store
  {
  public:
    std::map<std::string, std::vector<double>> bodies, points, common;
    std::map<std::string, std::vector<std::uint8_t>> kinds;
    std::unique_ptr<Archive> archive; ///< over it
  };

  class BisectionTransfer::Writer final : public Archive
  {
  public:
    explicit Writer(Store &store) : Archive(false), store_(store) {}

    void bodies(const std::string &name, std::vector<double> &values) override
    {
      store_.bodies[path(name)] = values;
    }
    void points(const std::string &name, std::vector<double> &values) override
    {
      store_.points[path(name)] = values;
    }
    void points(const std::string &name,
                std::vector<std::uint8_t> &values) override
    {
      store_.kinds[path(name)] = values;
    }
    void histories(const std::string &, std::vector<double> &) override
    {
      throw std::logic_error("bisected cells have no internal variables");
    }
    void cells(const std::string &, std::vector<double> &) override {}
    void common(const std::string &name, std::vector<double> &values) override
    {
      store_.common[path(name)] = values;
    }
    void on_root(const std::string &name, std::vector<double> &values) override
    {
      common(name, values);
    }
    void on_root(const std::string &, std::string &) override {}

  private:
    Store &store_;
  };

  class BisectionTransfer::Reader final : public Archive
  {
  public:
    Reader(const BisectionTransfer &transfer, const Store &store)
        : Archive(true), transfer_(transfer), store_(store)
    {
    }

    void bodies(const std::string &name, std::vector<double> &values) override
    {
      if (name != front_name)
        throw std::logic_error("bisected cells have no " + name);
      values = transfer_.front(store_.bodies.at(path(name)));
    }
    void points(const std::string &name, std::vector<double> &values) override
    {
      const auto &old = store_.points.at(path(name));
      if (name == "squared_tractions") // new faces have none: no step was taken
        values.assign(transfer_.origins_.size(),
                      std::numeric_limits<double>::infinity());
      else if (name == "jump")
        values = transfer_.jumps(old, store_.kinds.at(path("kind")), 2);
      else
        values = transfer_.pointwise(old, 0.);
    }
    void points(const std::string &name,
                std::vector<std::uint8_t> &values) override
    {
      values = transfer_.pointwise(store_.kinds.at(path(name)),
                                   std::uint8_t(PointKind::bonded));
    }
    void histories(const std::string &, std::vector<double> &) override {}
    void cells(const std::string &, std::vector<double> &) override {}
    void common(const std::string &name, std::vector<double> &values) override
    {
      values = store_.common.at(path(name));
      if (name == "front" && !transfer_.rates_.empty())
        values[2] = transfer_.stored_by_front_;
    }
    void on_root(const std::string &name, std::vector<double> &values) override
    {
      common(name, values);
    }
    void on_root(const std::string &, std::string &) override {}

  private:
    const BisectionTransfer &transfer_;
    const Store &store_;
  };

  BisectionTransfer::BisectionTransfer(const Bisection &cells,
                                       const Discretization<2> &discretization,
                                       const JoinedMesh<2> &mesh)
      : cells_(cells), old_weights_(discretization.points().weight),
        store_(std::make_unique<Store>())
  {
    const auto &faces = discretization.points().faces;
    old_faces_.reserve(faces.size());
    for (const auto &face : faces)
      add_face(face.first, discretization, mesh);
  }

  BisectionTransfer::~BisectionTransfer() = default;

  void BisectionTransfer::add_face(const unsigned int first,
                                   const Discretization<2> &discretization,
                                   const JoinedMesh<2> &mesh)
  {
    const auto &origin = discretization.origins()[first];
    // corners are those of the cells, three each
    const auto vertex = [&](const unsigned int point) {
      const unsigned int corner = mesh.a_corner(point);
      return cells_.old_cells()[corner / 3][corner % 3];
    };
    const unsigned int a = vertex(first), b = vertex(first + 1);
    OldFace face{origin.kind, 0, {{first, first + 1}}};
    if (origin.kind != PointOrigin::Kind::interface)
      face.block = origin.block;
    if (b < a)
      std::swap(face.points[0], face.points[1]);
    old_faces_.emplace(Bisection::edge(a, b), face);
  }

  /** How far it is from the first to the second end of an old edge. */
  double
  BisectionTransfer::share_of(const unsigned int vertex,
                              const std::array<unsigned int, 2> &edge) const
  {
    if (vertex == edge[0])
      return 0.;
    if (vertex == edge[1])
      return 1.;
    const auto &ends = cells_.ends(vertex);
    return (share_of(ends[0], edge) + share_of(ends[1], edge)) / 2.;
  }

  void BisectionTransfer::find_origins(const unsigned int first,
                                       const Discretization<2> &discretization,
                                       const JoinedMesh<2> &mesh)
  {
    const auto &origin = discretization.origins()[first];
    std::array<unsigned int, 2> here{};
    for (unsigned int k = 0; k < 2; ++k) {
      const unsigned int corner = mesh.a_corner(first + k);
      here[k] = cells_.cells()[corner / 3].vertices[corner % 3];
    }
    // up to the edge of the old mesh that it is a part of
    std::array<unsigned int, 2> edge = {
        {std::min(here[0], here[1]), std::max(here[0], here[1])}};
    while (old_faces_.count(Bisection::edge(edge[0], edge[1])) == 0) {
      const auto &ends = cells_.ends(edge[1]); // the later one
      if (ends[0] != edge[0] && ends[1] != edge[0])
        return; // inside an old cell
      edge = ends;
    }
    const auto range =
        old_faces_.equal_range(Bisection::edge(edge[0], edge[1]));
    const auto old =
        std::find_if(range.first, range.second, [&](const auto &one) {
          return one.second.kind == origin.kind &&
                 (origin.kind == PointOrigin::Kind::interface ||
                  one.second.block == origin.block);
        });
    if (old == range.second)
      return;
    std::array<double, 2> share{};
    for (unsigned int k = 0; k < 2; ++k)
      share[k] = share_of(here[k], edge);
    const bool is_whole = std::min(share[0], share[1]) == 0. &&
                          std::max(share[0], share[1]) == 1.;
    for (unsigned int k = 0; k < 2; ++k) {
      const double at = is_whole ? share[k] : (share[0] + share[1]) / 2.;
      Origin &mine = origins_[first + k];
      mine.ends = old->second.points;
      mine.own = mine.ends[at < 0.5 ? 0 : 1];
      mine.share = share[k];
      mine.weight = is_whole ? 1.
                             : discretization.points().weight[first + k] /
                                   old_weights_[mine.own];
    }
  }

  Archive &BisectionTransfer::old_parts()
  {
    store_->archive = std::make_unique<Writer>(*store_);
    return *store_->archive;
  }

  Archive &BisectionTransfer::new_parts()
  {
    store_->archive = std::make_unique<Reader>(*this, *store_);
    return *store_->archive;
  }

  void BisectionTransfer::set_mesh(const Discretization<2> &discretization,
                                   const JoinedMesh<2> &mesh)
  {
    const auto &points = discretization.points();
    origins_.assign(points.n_points, {});
    for (const auto &face : points.faces)
      find_origins(face.first, discretization, mesh);
    for (std::size_t i = 0; i < origins_.size(); ++i)
      if (origins_[i].own == Bisection::none &&
          discretization.origins()[i].kind != PointOrigin::Kind::interface)
        throw std::logic_error("a condition at the boundary holds on a part of "
                               "an edge alone");
  }

  void BisectionTransfer::add_value(const std::vector<double> &old,
                                    const unsigned int cell,
                                    const unsigned int vertex,
                                    const double share, double *value) const
  {
    const auto &corners = cells_.old_cells()[cell];
    const auto at = std::find(corners.begin(), corners.end(), vertex);
    if (at != corners.end()) {
      const std::size_t corner = 3 * cell + std::size_t(at - corners.begin());
      for (unsigned int c = 0; c < 2; ++c)
        value[c] += share * old[2 * corner + c];
      return;
    }
    for (const unsigned int end : cells_.ends(vertex))
      add_value(old, cell, end, share / 2., value);
  }

  /**
   * Two components at each of the three corners of a cell. Two halves have the
   * node in the middle of their edge no more: a quarter of the mass of the
   * whole is there, and goes with its velocity to the ends of the edge.
   */
  std::vector<double> BisectionTransfer::nodal(const std::vector<double> &old,
                                               const Field field) const
  {
    std::vector<double> result;
    result.reserve(6 * cells_.cells().size());
    for (const auto &cell : cells_.cells())
      for (unsigned int i = 0; i < 3; ++i) {
        const unsigned int v = cell.vertices[i];
        double value[2] = {};
        if (cell.other == Bisection::none || i == 0)
          add_value(old, cell.old, v, 1., value);
        else {
          const unsigned int half = i == 1 ? cell.old : cell.other,
                             middle = cells_.old_cells()[half][0];
          const double share = field == Field::velocity ? 0.5 : 0.;
          add_value(old, half, v, 1. - share, value);
          add_value(old, half, middle, share, value);
        }
        result.insert(result.end(), value, value + 2);
      }
    return result;
  }

  void BisectionTransfer::set_motion(const Discretization<2> &discretization,
                                     const State &given, const State &taken)
  {
    rates_.assign(cells_.cells().size(),
                  std::numeric_limits<double>::quiet_NaN());
    dilatations_.resize(rates_.size());
    for (std::size_t k = 0; k < rates_.size(); ++k) {
      const LinearTriangle shape(discretization.cells(), k);
      dilatations_[k] =
          shape.area * shape.dilatation(&taken.displacement[6 * k]);
      const double *const v = &taken.velocity[6 * k];
      if (cells_.cells()[k].other != Bisection::none ||
          !std::equal(v, v + 6, given.velocity.begin() + 6 * long(k)))
        rates_[k] = shape.dilatation(v);
    }
  }

  /**
   * Four numbers in the first places of the unknowns of a cell. Halves that are
   * joined have the mean of their viscosities; the tension is viscosity times
   * rate, or the balance of energy would not close.
   */
  std::vector<double>
  BisectionTransfer::front(const std::vector<double> &old) const
  {
    std::vector<double> result(6 * cells_.cells().size(), 0.);
    for (std::size_t k = 0; k < cells_.cells().size(); ++k) {
      const auto &cell = cells_.cells()[k];
      double *const mine = &result[6 * k];
      std::copy_n(&old[6 * std::size_t(cell.old)], 4, mine);
      if (cell.other != Bisection::none)
        for (const Front part : {next_viscosity, viscosity})
          mine[part] =
              (mine[part] + old[6 * std::size_t(cell.other) + part]) / 2.;
      if (rates_.empty() || std::isnan(rates_[k]))
        continue;
      mine[rate] = rates_[k];
      mine[tension] = mine[viscosity] * rates_[k];
    }
    stored_by_front_ = 0.;
    for (std::size_t k = 0; k < dilatations_.size(); ++k)
      stored_by_front_ += result[6 * k + tension] * dilatations_[k];
    return result;
  }

  std::vector<double> BisectionTransfer::front_viscosities() const
  {
    std::vector<double> result(cells_.old_cells().size(), 0.);
    for (const auto &[name, values] : store_->bodies) // there is one at most
      for (std::size_t k = 0; k < result.size(); ++k)
        result[k] = values[6 * k + viscosity];
    return result;
  }

  template <typename T>
  std::vector<T> BisectionTransfer::pointwise(const std::vector<T> &old,
                                              const T fresh) const
  {
    const std::size_t width = old.size() / old_weights_.size();
    std::vector<T> result(origins_.size() * width, fresh);
    for (std::size_t i = 0; i < origins_.size(); ++i)
      if (origins_[i].own != Bisection::none)
        std::copy_n(old.begin() + long(origins_[i].own * width), width,
                    result.begin() + long(i * width));
    return result;
  }

  /** Along faces that are free at both of their old points that of the nodes.
   */
  std::vector<double>
  BisectionTransfer::jumps(const std::vector<double> &old,
                           const std::vector<std::uint8_t> &kinds,
                           const unsigned int width) const
  {
    auto result = pointwise(old, 0.);
    for (std::size_t i = 0; i < origins_.size(); ++i) {
      const Origin &origin = origins_[i];
      const auto &[a, b] = origin.ends;
      if (origin.own == Bisection::none ||
          PointKind(kinds[a]) != PointKind::free ||
          PointKind(kinds[b]) != PointKind::free)
        continue;
      for (unsigned int c = 0; c < width; ++c)
        result[i * width + c] = (1. - origin.share) * old[a * width + c] +
                                origin.share * old[b * width + c];
    }
    return result;
  }

  State BisectionTransfer::state(const State &old) const
  {
    State result = old;
    result.displacement = nodal(old.displacement, Field::displacement);
    result.velocity = nodal(old.velocity, Field::velocity);
    for_point_fields(
        [&](const PointField &, const auto member, const auto &...) {
          using T = typename std::decay_t<decltype(old.*member)>::value_type;
          result.*member = pointwise(old.*member, T());
        });
    std::vector<std::uint8_t> kinds(old.kind.size());
    for (std::size_t i = 0; i < kinds.size(); ++i)
      kinds[i] = std::uint8_t(old.kind[i]);
    result.jump = jumps(old.jump, kinds, 2);
    result.released_overlap = jumps(old.released_overlap, kinds, 1);
    for (std::size_t i = 0; i < origins_.size(); ++i) {
      const Origin &origin = origins_[i];
      if (origin.own == Bisection::none) {
        result.kind[i] = PointKind::bonded;
        result.beta[i] = 1.;
        continue;
      }
      for (unsigned int c = 0; c < 2; ++c) {
        result.impulse[2 * i + c] *= origin.weight;
        result.relative_velocity[2 * i + c] =
            (1. - origin.share) *
                old.relative_velocity[2 * origin.ends[0] + c] +
            origin.share * old.relative_velocity[2 * origin.ends[1] + c];
      }
    }
    return result;
  }
} // namespace nsfd
