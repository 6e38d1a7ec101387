#include "fragment_motion.h"

#include "bodies/moving_bodies.h"
#include "core/gather.h"
#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include "core/order_free_sum.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace space;

  /** A cell, or a rigid body of large motions, about its own centre. */
  template <int dim>
  struct FragmentMotion<dim>::Body {
    unsigned int cell = 0; ///< the first one
    double mass = 0., kinetic = 0.;
    Vec3 centre{}, velocity{};
    Vec3 angular_momentum{};
    Mat3 inertia{};
  };

  /** Where a fragment is and how fast, known to all its pieces. */
  template <int dim>
  struct FragmentMotion<dim>::Place {
    Vec3 centre, velocity;
  };

  /** What a piece adds to its fragment, first turn. */
  template <int dim>
  struct FragmentMotion<dim>::Amounts {
    unsigned int number = 0;
    unsigned long long cells = 0;
    OrderFreeSum mass, volume, kinetic, surface;
    std::array<OrderFreeSum, dim> moment, momentum;

    void add(const Amounts &other)
    {
      cells += other.cells;
      mass.add(other.mass);
      volume.add(other.volume);
      kinetic.add(other.kinetic);
      surface.add(other.surface);
      for (unsigned int c = 0; c < dim; ++c) {
        moment[c].add(other.moment[c]);
        momentum[c].add(other.momentum[c]);
      }
    }
  };

  /** Second turn, about the centre of the fragment. */
  template <int dim>
  struct FragmentMotion<dim>::Motions {
    static constexpr unsigned int n_spins = dim == 2 ? 1 : 3,
                                  n_inertias = dim == 2 ? 1 : 6;
    unsigned int number = 0;
    std::array<OrderFreeSum, n_spins> angular_momentum;
    std::array<OrderFreeSum, n_inertias> inertia;

    void add(const Body &body, const Place &place)
    {
      const Vec3 r = body.centre - place.centre;
      const Vec3 L = body.angular_momentum +
                     body.mass * cross(r, body.velocity - place.velocity);
      Mat3 J = body.inertia;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          J[i][j] += body.mass * ((i == j ? dot(r, r) : 0.) - r[i] * r[j]);
      if constexpr (dim == 2) {
        angular_momentum[0].add(L[2]);
        inertia[0].add(J[2][2]);
      } else {
        for (unsigned int c = 0; c < 3; ++c) {
          angular_momentum[c].add(L[c]);
          inertia[c].add(J[c][c]);
        }
        inertia[3].add(J[0][1]);
        inertia[4].add(J[0][2]);
        inertia[5].add(J[1][2]);
      }
    }

    void add(const Motions &other)
    {
      for (unsigned int c = 0; c < n_spins; ++c)
        angular_momentum[c].add(other.angular_momentum[c]);
      for (unsigned int c = 0; c < n_inertias; ++c)
        inertia[c].add(other.inertia[c]);
    }

    void finish(FragmentRecord &record) const
    {
      Vec3 L{};
      if constexpr (dim == 2) {
        L[2] = angular_momentum[0].value();
        record.inertia[2][2] = inertia[0].value();
        record.spin[2] = L[2] / record.inertia[2][2];
      } else {
        Mat3 &J = record.inertia;
        for (unsigned int c = 0; c < 3; ++c) {
          L[c] = angular_momentum[c].value();
          J[c][c] = inertia[c].value();
        }
        J[0][1] = J[1][0] = inertia[3].value();
        J[0][2] = J[2][0] = inertia[4].value();
        J[1][2] = J[2][1] = inertia[5].value();
        record.spin = solve(J, L);
      }
      record.kinetic_translation =
          0.5 * record.mass * dot(record.velocity, record.velocity);
      record.kinetic_spin = 0.5 * dot(L, record.spin);
    }
  };

  /** The fragments that this rank has cells of. */
  template <int dim>
  class FragmentMotion<dim>::Pieces
  {
  public:
    explicit Pieces(const std::vector<unsigned int> &number_of_body)
        : numbers_(number_of_body)
    {
      std::sort(numbers_.begin(), numbers_.end());
      numbers_.erase(std::unique(numbers_.begin(), numbers_.end()),
                     numbers_.end());
      for (const unsigned int number : number_of_body)
        piece_.push_back(unsigned(
            std::lower_bound(numbers_.begin(), numbers_.end(), number) -
            numbers_.begin()));
    }

    unsigned int of_cell(const unsigned int cell) const { return piece_[cell]; }
    std::size_t size() const { return numbers_.size(); }

    /** One of each, with its number. */
    template <typename Sums>
    std::vector<Sums> make() const
    {
      std::vector<Sums> result(size());
      for (std::size_t k = 0; k < size(); ++k)
        result[k].number = numbers_[k];
      return result;
    }

  private:
    std::vector<unsigned int> numbers_, piece_;
  };

  namespace
  {
    /** By number, of pieces of all ranks. */
    template <typename Sums>
    std::vector<Sums> joined(const std::vector<Sums> &pieces)
    {
      unsigned int n = 0;
      for (const Sums &piece : pieces)
        n = std::max(n, piece.number + 1);
      std::vector<Sums> result(n);
      for (const Sums &piece : pieces) {
        result[piece.number].number = piece.number;
        result[piece.number].add(piece);
      }
      return result;
    }
  } // namespace

  template <int dim>
  FragmentMotion<dim>::FragmentMotion(const Discretization<dim> &discretization,
                                      const Communicator &communicator,
                                      const MovingBodies<dim> *moving,
                                      const State &start)
      : discretization_(discretization), communicator_(communicator)
  {
    const SceneInput &input = discretization.input();
    if (!moving && input.has_body_table() &&
        discretization.body_table().n_rigid)
      own_layout_ =
          std::make_shared<const BodyLayout<dim>>(input, discretization);
    layout_ = moving ? &moving->layout() : own_layout_.get();
    mesh_changed(start);
  }

  template <int dim>
  void FragmentMotion<dim>::mesh_changed(const State &start)
  {
    held_at_start_.clear();
    for (const double beta : start.beta)
      held_at_start_.push_back(beta >= 1e-3);
    masses_.clear();
    for (const auto &body : discretization_.bodies().classes) {
      auto &mass = masses_.emplace_back();
      if (body.bodies.empty() || discretization_.cells().differ())
        continue;
      const auto of_body = discretization_.cells().shape(body.bodies[0]);
      const BodyShape<dim> &shape = *of_body;
      const Block &nodal = body.rigid ? shape.nodal_mass : body.mass;
      constexpr unsigned int along = dim - 1; // moves on an axis, too
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        for (unsigned int j = 0; j < shape.n_nodes; ++j)
          mass.push_back(nodal(i * dim + along, j * dim + along));
    }
  }

  template <int dim>
  auto FragmentMotion<dim>::cell_body(const unsigned int cell,
                                      const std::vector<double> &displacement,
                                      const std::vector<double> &velocity) const
      -> Body
  {
    const auto of_body = discretization_.cells().shape(cell);
    const BodyShape<dim> &shape = *of_body;
    const unsigned int n = shape.n_nodes;
    thread_local std::vector<double> lumped;
    if (discretization_.cells().differ()) {
      lumped.assign(n * n, 0.);
      for (unsigned int i = 0; i < n; ++i)
        lumped[i * n + i] = lumped_mass(shape, i);
    }
    const auto &mass = discretization_.cells().differ()
                           ? lumped
                           : masses_[discretization_.bodies().class_of[cell]];
    const auto corner = discretization_.cells().corners[cell][0];
    const std::size_t first = discretization_.cells().first_node[cell] * dim;
    thread_local std::vector<Vec3> x, v;
    x.assign(n, Vec3{});
    v.assign(n, Vec3{});
    Body body;
    body.cell = cell;
    for (unsigned int i = 0; i < n; ++i) {
      for (unsigned int c = 0; c < dim; ++c) {
        x[i][c] =
            corner[c] + shape.nodes[i][c] + displacement[first + i * dim + c];
        v[i][c] = velocity[first + i * dim + c];
      }
      double weight = 0.;
      for (unsigned int j = 0; j < n; ++j)
        weight += mass[i * n + j];
      body.mass += weight;
      body.centre = body.centre + weight * x[i];
      body.velocity = body.velocity + weight * v[i];
    }
    body.centre = (1. / body.mass) * body.centre;
    body.velocity = (1. / body.mass) * body.velocity;
    Mat3 moment{};
    double vibration = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      x[i] = x[i] - body.centre;
      v[i] = v[i] - body.velocity;
    }
    for (unsigned int i = 0; i < n; ++i) {
      Vec3 Mr{}, Mv{};
      for (unsigned int j = 0; j < n; ++j) {
        Mr = Mr + mass[i * n + j] * x[j];
        Mv = Mv + mass[i * n + j] * v[j];
      }
      body.angular_momentum = body.angular_momentum + cross(x[i], Mv);
      vibration += dot(v[i], Mv);
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          moment[a][b] += x[i][a] * Mr[b];
    }
    const double trace = moment[0][0] + moment[1][1] + moment[2][2];
    for (unsigned int a = 0; a < 3; ++a)
      for (unsigned int b = 0; b < 3; ++b)
        body.inertia[a][b] = (a == b ? trace : 0.) - moment[a][b];
    body.kinetic =
        0.5 * (body.mass * dot(body.velocity, body.velocity) + vibration);
    return body;
  }

  template <int dim>
  auto FragmentMotion<dim>::rigid_body(const MovingBody &moving,
                                       const State &state) const -> Body
  {
    const RigidInertia &inertia = moving.inertia;
    const RigidState rigid =
        rigid_state(state.rigid.data() + 13 * moving.rigid_number);
    const Mat3 R = rotation(rigid.orientation);
    Body body;
    body.mass = inertia.mass;
    body.centre = rigid.centre;
    body.velocity = rigid.velocity;
    body.angular_momentum = nsfd::angular_momentum(inertia, rigid);
    body.inertia = R * inertia.inertia * transposed(R);
    body.kinetic = kinetic_energy(inertia, rigid);
    return body;
  }

  /** Made when they are asked for: all at once are more than the mesh. */
  template <int dim>
  template <typename Visit>
  void FragmentMotion<dim>::for_bodies(const State &state, Visit &&visit) const
  {
    // where no cell is rigid unknowns are values at nodes
    const bool has_rigid =
        discretization_.cells().n_nodal() > state.displacement.size();
    std::vector<double> nodal[2];
    if (has_rigid) {
      nodal[0] = discretization_.to_nodal(state.displacement);
      nodal[1] = discretization_.to_nodal(state.velocity);
    }
    const auto &displacement = has_rigid ? nodal[0] : state.displacement;
    const auto &velocity = has_rigid ? nodal[1] : state.velocity;
    std::vector<char> seen(layout_ ? layout_->size() : 0, 0);
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      if (!layout_ || !(*layout_)[layout_->body_of_cell(c)].is_rigid()) {
        visit(cell_body(c, displacement, velocity));
        continue;
      }
      const unsigned int b = layout_->body_of_cell(c);
      if (seen[b])
        continue;
      seen[b] = 1;
      Body body = rigid_body((*layout_)[b], state);
      body.cell = c;
      visit(body);
    }
  }

  template <int dim>
  auto FragmentMotion<dim>::amounts(const State &state,
                                    const Pieces &pieces) const
      -> std::vector<Amounts>
  {
    auto sums = pieces.template make<Amounts>();
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      Amounts &sum = sums[pieces.of_cell(c)];
      ++sum.cells;
      sum.volume.add(discretization_.cells().volume(c));
    }
    for_bodies(state, [&](const Body &body) {
      Amounts &sum = sums[pieces.of_cell(body.cell)];
      sum.mass.add(body.mass);
      sum.kinetic.add(body.kinetic);
      for (unsigned int c = 0; c < dim; ++c) {
        sum.moment[c].add(body.mass * body.centre[c]);
        sum.momentum[c].add(body.mass * body.velocity[c]);
      }
    });
    const auto &points = discretization_.points();
    for (const auto &face : points.faces)
      for (unsigned int i = face.first; i < face.first + face.count; ++i)
        if (!face.boundary && state.beta[i] < 1e-3 && held_at_start_[i])
          for (const int side : face.bodies)
            if (side >= 0)
              sums[pieces.of_cell(unsigned(side))].surface.add(
                  points.weight[i]);
    return sums;
  }

  template <int dim>
  std::vector<FragmentRecord>
  FragmentMotion<dim>::measure(const State &state,
                               const Fragments<dim> &fragments) const
  {
    const Pieces pieces(fragments.number_bodies());
    std::vector<int> n_per_rank;
    const auto all = gather(communicator_, amounts(state, pieces), n_per_rank);
    const auto sums = joined(all);
    std::vector<FragmentRecord> records;
    for (const Amounts &sum : sums) {
      FragmentRecord &record = records.emplace_back();
      record.number = sum.number;
      record.axisymmetric = discretization_.input().axisymmetric;
      record.cells = sum.cells;
      record.mass = sum.mass.value();
      record.volume = sum.volume.value();
      record.kinetic = sum.kinetic.value();
      record.surface = sum.surface.value();
      for (unsigned int c = 0; c < dim; ++c) {
        record.centre[c] = sum.moment[c].value() / record.mass;
        record.velocity[c] = sum.momentum[c].value() / record.mass;
      }
    }
    std::vector<Place> places;
    for (const Amounts &piece : all)
      places.push_back(
          {records[piece.number].centre, records[piece.number].velocity});
    places = scatter(communicator_, places, n_per_rank);
    auto motions = pieces.template make<Motions>();
    for_bodies(state, [&](const Body &body) {
      const unsigned int piece = pieces.of_cell(body.cell);
      motions[piece].add(body, places[piece]);
    });
    for (const Motions &motion : joined(gather(communicator_, motions)))
      motion.finish(records[motion.number]);
    return records;
  }

  template class FragmentMotion<2>;
  template class FragmentMotion<3>;
} // namespace nsfd
