#pragma once

#include "face_traces.h"

#include <memory>
#include <string>

namespace nsfd
{
  class Archive;

  /**
   * The bodies seen from the faces: H, M_hat^{-1} and W = H M_hat^{-1} H^T,
   * with M_hat = M + h^2 theta^2 K, and + h theta C where bodies are viscous,
   * block diagonal by body; see StepTerms for explicit forces. Vectors
   * over points are in the local frames, dim entries per point; vectors over
   * bodies have Bodies::n_dofs() entries.
   *
   * Both paths share this operator. They differ in how a Newton system
   * (W + D) x = r is preconditioned: on the local path by face blocks, on the
   * assembled one by a sparse factor or multigrid of A = M_hat + H^T D^{-1} H
   * (Woodbury).
   */
  template <int dim>
  class DelassusOperator : public FaceTraces<dim>
  {
  public:
    DelassusOperator(const Communicator &communicator, const Bodies &bodies,
                     const InterfacePoints<dim> &points);
    virtual ~DelassusOperator() = default;

    /** Build what depends on the step; nothing if it has not changed. */
    virtual void reinit(double time_step, double theta);

    /** Bodies or points are others than before: everything anew. Collective. */
    void renew(double time_step, double theta);

    /**
     * U = W P over all points. One exchange with the neighbouring ranks, behind
     * the work for bodies that share no point with them.
     */
    virtual void apply_delassus(const double *impulse, double *velocity) const;

    /**
     * The Cartesian contributions of both bodies to W P at every point (body 1
     * with its sign), each of size (n_points + 1) dim, complete at shared
     * points: what Gauss-Seidel keeps up to date.
     */
    void delassus_sides(const double *impulse,
                        std::array<std::vector<double>, 2> &side) const;

    /** dv += M_hat^{-1} H^T P. */
    virtual void add_velocity_change(const double *impulse,
                                     double *velocity) const;

    enum class Operator {
      mass,
      stiffness,
      inverse, ///< M_hat^{-1}
      damping  ///< of viscous bodies
    };
    /**
     * y = A x. Where bodies share nodes, of a motion that they share: y then is
     * complete by node, not by body.
     */
    virtual void apply(Operator op, const double *x, double *y) const;

    /** Gauss-Seidel can work: what one body does no other one feels. */
    virtual bool bodies_are_apart() const { return true; }

    /**
     * Diagonal block of W of a point in its frame, row-major; at least that
     * where bodies share nodes.
     */
    const double *point_block(const std::size_t point) const
    {
      return point_blocks_.data() + point * dim * dim;
    }

    /**
     * The same of the points of a face as a whole, row-major of size
     * (count dim)^2. Of operators that keep them.
     */
    const double *face_block(const std::size_t face) const
    {
      return face_blocks_.data() + face_offset_[face];
    }

    /**
     * Prepare the preconditioner for W + diag(D) on the components with
     * D >= 0; negative D marks a component that does not take part.
     */
    virtual void prepare_preconditioner(const std::vector<double> &D) = 0;
    /** z = approximation of (W + D)^{-1} r on the components that take part. */
    virtual void precondition(const double *r, double *z) const = 0;

    /**
     * Whether precondition() inverts the whole matrix it was prepared for, up
     * to the inner tolerance: no component without compliance, no face left
     * out.
     */
    virtual bool inverts() const { return false; }

    /**
     * One Newton step in velocities: impulses P* with
     *
     *     M_hat v = M_hat v_free + H^T P*,
     *     D (P* - P) + H v - U + r = 0     where D > 0 takes part,
     *
     * and the D of the preconditioner where D = 0, a proximal step; @p next
     * holds P* of the components that do not take part and all of them on
     * return. A null @p U is zero: laws that know r - U by themselves, not from
     * the U at hand, put it into @p r. The right-hand side is a momentum of the
     * order of P*, whatever the step and the stiffness, while (W + D) dP = -r
     * loses the digits of W/D on its way through D^{-1} r. @p tolerance is that
     * of an iterative solve, relative to its start, the velocities of the last
     * one. Returns false where there is no such solver or no v_free.
     */
    virtual bool solve_springs(const double * /*P*/, const double * /*U*/,
                               const double * /*r*/, double /*tolerance*/,
                               double * /*next*/)
    {
      return false;
    }

    /** v_free behind the U_free of the problems to come; it stays the owner's.
     */
    void set_free_velocity(const std::vector<double> *v_free)
    {
      free_velocity_ = v_free;
    }

    /**
     * Relative tolerance of the iterative solve inside precondition(), in the
     * norm of its own preconditioner; a factor knows nothing of it.
     */
    void set_inner_tolerance(const double tolerance)
    {
      inner_tolerance_ = tolerance;
    }

    /**
     * What stands for D = 0 in the preconditioner of the assembled path, one
     * per component; empty: a share of the diagonal of W, which at long steps
     * is far more than the bodies' own compliance.
     */
    void set_least_compliance(std::vector<double> compliance)
    {
      least_compliance_ = std::move(compliance);
    }

    /** theta of M_hat = M + h^2 theta^2 K; that of the positions may differ. */
    double bulk_theta() const { return theta_; }

    /** Of the next reinit() on. */
    void set_terms(const StepTerms &terms)
    {
      if (terms.viscous_theta != terms_.viscous_theta ||
          terms.shares(time_step_, theta_).stiffness !=
              terms_.shares(time_step_, theta_).stiffness)
        time_step_ = 0.; // another M_hat
      terms_ = terms;
    }
    const StepTerms &terms() const { return terms_; }

    /** What M_hat of a step consists of. */
    StepShares shares(const double time_step, const double theta) const
    {
      return terms_.shares(time_step, theta);
    }

    struct Counters {
      unsigned long long factorisations = 0; ///< of body blocks
      /// matrices of all bodies that were assembled and made ready to solve
      unsigned long long global_factorisations = 0;
      /// joined spaces that were built again (`cg`)
      unsigned long long coarse_spaces = 0;
      /// iterations inside precondition(), each one product with A (`cg`)
      unsigned long long inner_iterations = 0;
      unsigned long long global_solves = 0; ///< with one right-hand side each
      unsigned long long delassus = 0;
    };
    const Counters &counters() const { return counters_; }
    /** Counts go on where those of another mesh have ended. */
    void continue_counters(const Counters &counters) { counters_ = counters; }

    /**
     * What changes the bits of later steps: the step, and what is kept of
     * earlier solves. Factors are made again from it.
     */
    virtual void serialize(Archive &archive);

    /** Contribution of each body to W P, used by Gauss-Seidel. */
    struct ClassBlocks {
      Block inverse, delassus, velocity_change; ///< M^-1, T M^-1 T^T, M^-1 T^T
    };
    const std::vector<ClassBlocks> &class_blocks() const { return blocks_; }

  protected:
    using FaceTraces<dim>::communicator_;
    using FaceTraces<dim>::bodies_;
    using FaceTraces<dim>::points_;
    using FaceTraces<dim>::cartesian_;
    using FaceTraces<dim>::side_1_;
    using FaceTraces<dim>::side_2_;
    double time_step_ = 0., theta_ = 0.;
    std::vector<ClassBlocks> blocks_;
    bool keeps_face_blocks_ = false;
    std::vector<double> point_blocks_, face_blocks_;
    std::vector<std::size_t> face_offset_;
    mutable Counters counters_;

    std::vector<double> least_compliance_;
    double inner_tolerance_ = 1e-11;
    const std::vector<double> *free_velocity_ = nullptr;

  private:
    StepTerms terms_;
  };

  /**
   * The same operator for bodies and points that change: renew() is cheap,
   * nothing is kept in another form.
   */
  template <int dim>
  std::unique_ptr<DelassusOperator<dim>>
  make_moving_delassus(const Communicator &communicator, const Bodies &bodies,
                       const InterfacePoints<dim> &points);

  /** Preconditioned by the face blocks of W: for Courant numbers up to some. */
  template <int dim>
  std::unique_ptr<DelassusOperator<dim>>
  make_local_delassus(const Communicator &communicator, const Bodies &bodies,
                      const InterfacePoints<dim> &points);

  /**
   * Preconditioned by the sparse matrix A of all bodies: for long steps.
   * @p solver is `direct` (Cholesky factor) or `cg` (conjugate gradients
   * preconditioned by body blocks and the joined space); `auto` takes the
   * factor while it is the cheaper one. @p coordinates holds, per unknown of a
   * deformable body, the coordinate of its node along its own component:
   * nodes at the same place on a face can be joined. Empty: nothing is joined.
   */
  template <int dim>
  std::unique_ptr<DelassusOperator<dim>> make_assembled_delassus(
      const Communicator &communicator, const Bodies &bodies,
      const InterfacePoints<dim> &points, const std::string &solver,
      const std::vector<double> &coordinates = {});
} // namespace nsfd
