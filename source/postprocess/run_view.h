#pragma once

#include "bodies/cell_stresses.h"
#include "discretization/body_shape.h"
#include "discretization/cell_sampler.h"

#include "mesh/mesh_builder.h"
#include "nsfd/postprocess/observable.h"
#include "state/state.h"

#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  /** What observables look at, from the bodies and points of this rank. */
  template <int dim>
  class RunViewOf final : public RunView
  {
  public:
    RunViewOf(const SceneInput &input,
              const Discretization<dim> &discretization,
              const Communicator &communicator);

    /** The mesh is there, or another one. */
    void find(const dealii::Triangulation<dim> &triangulation,
              const MeshGroups<dim> &groups);

    /** @p previous: before the step that ends in @p state, or null. */
    void show(const State &state, const State *previous, const HistoryRow &row);
    /** What was shown is gone. */
    void forget();

    const SceneInput &input() const override { return input_; }
    unsigned int dimension() const override { return dim; }
    double time() const override { return row_->time; }
    double time_step() const override { return row_->time_step; }
    const HistoryRow &row() const override { return *row_; }
    double cell_size() const override { return discretization_.cell_size(); }
    double crossing_time() const override
    {
      return discretization_.crossing_time();
    }
    const std::vector<Point> &points() const override { return points_; }
    PointState at(std::size_t point) const override;
    std::vector<Place> places(const NamedSurface &surface) const override;
    Vector reaction(unsigned int boundary) const override;
    double broken_beta(std::size_t point) const override;
    Means on(const NamedSurface &surface) const override;
    Means at(const Vector &place) const override;
    void
    visit_cells(const Vector &centre, double radius,
                const std::function<void(const CellPoint &)> &) const override;
    void
    visit_sides(const Vector &centre, double radius,
                const std::function<void(const SidePoint &)> &) const override;
    std::vector<double> sums(const std::vector<double> &terms,
                             unsigned int rows) const override;
    double max(double value) const override;
    double min(double value) const override;
    std::vector<double>
    gather(const std::vector<double> &values) const override;

  private:
    /** Nodal values at t_k + theta h, of a cell as of all. */
    struct Motion {
      std::vector<double> displacement, velocity, acceleration;
      double time = 0.;
    };
    /** A slot of a body on a block of the scene. */
    struct Slot {
      unsigned int body, slot;
    };

    void find_points();
    void find_boundary_faces(const dealii::Triangulation<dim> &triangulation,
                             const MeshGroups<dim> &groups);
    const Motion &motion() const;
    const std::vector<double> &displacement() const;
    const std::vector<double> &velocity() const;
    CellStresses<dim> &stresses() const;
    const Sampler<dim> &slots_of(unsigned int body) const;
    std::vector<Slot> slots_on(const NamedSurface &surface) const;
    std::optional<dealii::Point<dim>>
    reference_place(unsigned int body, const dealii::Point<dim> &x) const;
    bool reaches(unsigned int body, const Vector &centre, double radius) const;
    Means mean_of(const std::vector<double> &terms) const;
    Vector traction(std::size_t point) const;
    bool is_second(unsigned int material, const NamedSurface &contact) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    const State *state_ = nullptr, *previous_ = nullptr;
    const HistoryRow *row_ = nullptr;
    const HistoryRow no_row_;
    std::vector<Point> points_;
    std::vector<double> reach_; ///< of a body around its centre, m
    /// per boundary block: body and number of its face
    std::vector<std::vector<std::array<unsigned int, 2>>> boundary_faces_;
    mutable std::map<const BodyShape<dim> *, Sampler<dim>> samplers_;
    // of the present state, once somebody has asked
    mutable std::optional<Motion> motion_;
    mutable std::optional<std::vector<double>> displacement_, velocity_;
    mutable std::unique_ptr<CellStresses<dim>> stresses_;
  };
} // namespace nsfd
