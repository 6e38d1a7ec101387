#pragma once

#include "viewed_mesh.h"
#include "viewed_motion.h"

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

    /** The states that are looked at. */
    ViewedMotion<dim> &motion() { return motion_; }

    const SceneInput &input() const override { return input_; }
    unsigned int dimension() const override { return dim; }
    double time() const override { return motion_.row().time; }
    double time_step() const override { return motion_.row().time_step; }
    const HistoryRow &row() const override { return motion_.row(); }
    double cell_size() const override { return discretization_.cell_size(); }
    double crossing_time() const override
    {
      return discretization_.crossing_time();
    }
    const std::vector<Point> &points() const override { return points_; }
    PointState at(std::size_t point) const override;
    double beta(std::size_t point) const override
    {
      return motion_.state()->beta[point];
    }
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
    void find_points();

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    ViewedMesh<dim> mesh_;
    ViewedMotion<dim> motion_;
    std::vector<Point> points_;
  };
} // namespace nsfd
