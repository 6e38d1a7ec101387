#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  namespace
  {
    /**
     * Two Euler-Bernoulli beams of the height H, I = H^3/12 per width, apart
     * over the length a, on two-sided springs C_N ahead of it, pulled apart by
     * P at their ends (Kanninen, Int. J. Fract. 9, 1973; Li, Wang and Thouless,
     * J. Mech. Phys. Solids 52, 2004). With k = lambda, k^4 = C_N/(2 E I), and
     * springs over so long a ligament b that exp(-2 k b) is nothing,
     *
     *   C = (2 (k a)^3 + 6 (k a)^2 + 6 k a + 3)/(3 E I k^3),
     *   [u](x) = P e^{-k x} ((1 + k a) cos(k x) - k a sin(k x))/(E I k^3),
     *   G = P^2 (a + 1/k)^2/(E I) = C_N [u](0)^2/2.
     */
    struct BeamPair {
      double stiffness = 0., lambda = 0.; // E I, N m; 1/m

      double compliance(const double a) const
      {
        const double z = lambda * a;
        return (((2. * z + 6.) * z + 6.) * z + 3.) / (3. * unit());
      }
      /** Of the springs at @p x ahead of the crack, per force. */
      double jump(const double a, const double x) const
      {
        const double z = lambda * a, y = lambda * x;
        return std::exp(-y) * ((1. + z) * std::cos(y) - z * std::sin(y)) /
               unit();
      }
      double release(const double a, const double force) const
      {
        return std::pow(force * (a + 1. / lambda), 2) / stiffness;
      }

    private:
      double unit() const { return stiffness * std::pow(lambda, 3); }
    };
  } // namespace

  /**
   * Springs that do not break: compliance, jump at the front, and G from the
   * angles of the ends, G = 2 P theta, which holds for beams on any springs
   * (Paris and Paris, Int. J. Fract. 38, 1988). Observables `upper` and `lower`
   * are probes on the driven ends, `upper_edge` and `lower_edge` at their outer
   * edges, `upper_tip` and `lower_tip` next to the front.
   *
   * Springs that break at [u] = d_0, without softening: in beam theory from
   *
   *   P_c = (G_c E I)^{1/2}/(a + 1/lambda)
   *
   * on. The springs of a point break at once, with quarter points a piece of
   * the length s, half a cell, when its middle is open by d_0:
   *
   *   P_i = d_0/[u](s/2) at P = 1,   Delta_i = C(a_i) P_i,   a_i = a + i s,
   *
   * lambda s above P_c, to first order. The arms snap from piece to piece, and
   * release Delta_i^2/2 (1/C(a_i) - 1/C(a_{i+1})), 1 + 2 lambda s times G_c s.
   */
  class BeamsOnSprings final : public VerificationCase
  {
  public:
    explicit BeamsOnSprings(SectionReader &reader)
    {
      length_ = reader.number("length", "", units::length, Range::positive(),
                              "of the crack, a");
      young_ = reader.number("Young modulus", "", units::pressure,
                             Range::positive(), "of the beams, E");
    }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.dimension == 2, "the beams are in the plane");
      height_ = extent(input, 1) / 2.;
      read_foundation(input);
      read_ends(input);
      if (!grows_)
        return;
      demand(input.discretization.interface_quadrature == "quarter points",
             "springs that break need `interface quadrature = quarter points`");
      piece_ = extent(input, 0) / n_cells(input, 0) / 2.;
      demand(beams_.lambda * piece_ < 1., "the cells are too long");
    }

    void observe(const StepView &view) override
    {
      if (view.row->step == 0)
        return; // no reactions yet
      if (grows_)
        follow_growth(*view.row, view.time);
      else
        measure(view);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      if (grows_)
        finish_growth(errors);
      else
        finish_rest(errors);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", found_.opening, found_.jump, found_.release,
                      found_.n_broken, found_.load, found_.peak, found_.late,
                      found_.before, found_.loss, found_.damage,
                      found_.kinetic);
    }

  private:
    double length_ = 0., young_ = 0., height_ = 0.;
    BeamPair beams_;
    double slope_ = 0.;              // C_N
    bool grows_ = false;             // springs break
    double limit_ = 0., piece_ = 0.; // d_0, s
    Expression upper_, lower_;       // motion of the ends
    struct {
      double opening = 0., jump = 0., release = 0.;
      unsigned int n_broken = 0;
      double load = 0., peak = 0., late = 0., before = 0., loss = 0.,
             damage = 0., kinetic = 0.;
    } found_;

    void read_foundation(const SceneInput &input)
    {
      for (const InterfaceInput &block : input.interfaces) {
        if (block.name != "foundation")
          continue;
        grows_ = block.law != nullptr;
        demand(!grows_ || block.law_name == "brittle",
               "springs that break need `law = brittle`");
        demand(grows_ || block.law_name == "elastic",
               "springs that do not break need `law = elastic`");
        slope_ =
            grows_ ? block.law->normal_stiffness() : block.normal_stiffness;
        limit_ = grows_ ? block.law->elastic_limit() : 0.;
      }
      demand(slope_ > 0., "an Interface block `foundation` is missing");
      beams_.stiffness = young_ * std::pow(height_, 3) / 12.;
      beams_.lambda = std::pow(slope_ / (2. * beams_.stiffness), 0.25);
    }

    /** `upper` comes first: its reaction is that of the row. */
    void read_ends(const SceneInput &input)
    {
      demand(input.boundaries.size() == 2 &&
                 input.boundaries[0].name == "upper" &&
                 input.boundaries[1].name == "lower",
             "the boundaries must be `upper` and `lower`, in this order");
      const BoundaryInput &upper = input.boundaries[0],
                          &lower = input.boundaries[1];
      demand(upper.displacement[1] && lower.displacement[1],
             "`upper` and `lower` must be driven by `displacement y`");
      upper_ = *upper.displacement[1];
      lower_ = *lower.displacement[1];
    }

    double opening(const double t) const
    {
      return upper_(0., height_, 0., t) - lower_(0., -height_, 0., t);
    }

    void measure(const StepView &view)
    {
      const auto difference = [&](const std::string &upper,
                                  const std::string &lower,
                                  const std::string &column) {
        return view.observed(upper, column) - view.observed(lower, column);
      };
      found_.opening = opening(view.time);
      found_.load = view.row->reactions[1];
      found_.jump = difference("upper_tip", "lower_tip", "displacement_y");
      // the outer edges move inwards by theta H/2
      const double turns =
          (difference("upper_edge", "upper", "displacement_x") +
           difference("lower_edge", "lower", "displacement_x")) /
          (height_ / 2.);
      found_.release = found_.load * turns;
    }

    void finish_rest(std::map<std::string, double> &errors) const
    {
      const double compliance = beams_.compliance(length_),
                   G = beams_.release(length_, found_.load);
      errors["compliance"] =
          relative_error(found_.opening / found_.load, compliance);
      errors["tip_jump"] =
          relative_error(found_.jump, found_.load * beams_.jump(length_, 0.));
      errors["G"] = relative_error(found_.release, G);
      errors["exact_compliance"] = compliance;
    }

    double front(const unsigned int i) const { return length_ + i * piece_; }

    /** At which the piece behind @p i others breaks. */
    double breaking_load(const unsigned int i) const
    {
      return limit_ / beams_.jump(front(i), piece_ / 2.);
    }
    double breaking_opening(const unsigned int i) const
    {
      return beams_.compliance(front(i)) * breaking_load(i);
    }

    void follow_growth(const HistoryRow &row, const double t)
    {
      found_.opening = opening(t);
      const auto broken = unsigned(std::lround(row.broken_area / piece_));
      for (; found_.n_broken < broken; ++found_.n_broken) {
        if (found_.n_broken == 0) {
          found_.peak = found_.load;
          found_.before = found_.loss;
        }
        found_.late = std::max(
            found_.late,
            relative_error(found_.opening, breaking_opening(found_.n_broken)));
      }
      found_.load = row.reactions[1];
      found_.loss = row.energy.work - mechanical_energy(row);
      found_.damage = row.energy.damage;
      if (found_.n_broken > 0)
        found_.kinetic = std::max(found_.kinetic,
                                  row.energy.kinetic / mechanical_energy(row));
    }

    /** Of the snaps at which the first pieces have broken. */
    double exact_loss() const
    {
      double loss = 0.;
      for (unsigned int i = 0; i < found_.n_broken; ++i)
        loss += std::pow(breaking_opening(i), 2) / 2. *
                (1. / beams_.compliance(front(i)) -
                 1. / beams_.compliance(front(i + 1)));
      return loss;
    }

    void finish_growth(std::map<std::string, double> &errors) const
    {
      const double toughness = slope_ * limit_ * limit_ / 2.,
                   growth = found_.n_broken * piece_,
                   load = limit_ / beams_.jump(length_, 0.);
      unsigned int n = 0;
      while (breaking_opening(n) <= found_.opening)
        ++n;
      errors["started"] = found_.n_broken > 0 ? 0. : 1.;
      errors["first_load"] = relative_error(found_.peak, breaking_load(0));
      errors["openings"] = found_.late;
      errors["crack_length"] = relative_error(front(found_.n_broken), front(n));
      errors["last_load"] = relative_error(
          found_.load,
          found_.opening / beams_.compliance(front(found_.n_broken)));
      errors["kinetic"] = found_.kinetic;
      if (found_.n_broken > 0) {
        errors["damage"] = relative_error(found_.damage, toughness * growth);
        errors["loss"] =
            relative_error(found_.loss - found_.before, exact_loss());
        errors["exact_loss_over_G"] = exact_loss() / (toughness * growth);
      }
      errors["exact_load"] = load;
      errors["exact_first_load_over_load"] = breaking_load(0) / load;
    }
  };

  NSFD_REGISTER(VerificationRegistry, BeamsOnSprings, "beams on springs",
                "Two beams on springs pulled apart: compliance, G, jump; or "
                "growth of the crack",
                "length = 100 mm; Young modulus = 70 GPa");
} // namespace nsfd
