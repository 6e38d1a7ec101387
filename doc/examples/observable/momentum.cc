#include "nsfd/postprocess/observable_input.h"

#include <limits>

namespace nsfd
{
  /**
   * Mass and momentum of all bodies, int rho dV and int rho v dV (per metre of
   * depth in two dimensions). A step is in balance at t_k + theta h: that is
   * the time of the velocity, (1 - theta) h before the time of the row.
   */
  class Momentum final : public Observable
  {
  public:
    Momentum(SectionReader &, const SceneInput &scene)
        : dimension_(scene.dimension)
    {
    }

    std::vector<ObservedColumn> columns() const override
    {
      const bool in_plane = dimension_ == 2;
      std::vector<ObservedColumn> columns = {
          {"mass", in_plane ? "kg/m" : "kg"}};
      observables::add_vector(columns, "momentum", in_plane ? "N s/m" : "N s",
                              dimension_);
      return columns;
    }

    std::vector<double> values(const RunView &view) override
    {
      // a block of terms per column; sums() adds them up over all ranks, in a
      // way that does not depend on their order
      std::vector<std::vector<double>> blocks(1 + dimension_);
      const double everywhere = std::numeric_limits<double>::max();
      view.visit_cells({}, everywhere, [&](const RunView::CellPoint &point) {
        const double mass = point.density * point.JxW;
        blocks[0].push_back(mass);
        for (unsigned int c = 0; c < dimension_; ++c)
          blocks[1 + c].push_back(mass * point.velocity[c]);
      });
      std::vector<double> terms;
      for (const std::vector<double> &block : blocks)
        terms.insert(terms.end(), block.begin(), block.end());
      return view.sums(terms, 1 + dimension_);
    }

    std::string text() const override { return "of all bodies"; }

  private:
    const unsigned int dimension_;
  };

  NSFD_REGISTER(ObservableRegistry, Momentum, "momentum",
                "Mass and momentum of all bodies");
} // namespace nsfd
