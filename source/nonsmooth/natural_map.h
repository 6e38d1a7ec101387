#pragma once

namespace nsfd
{
  /**
   * The measure of every solver and of the step, the relative natural map:
   * with P* the solutions of the local problems, in which each point by itself
   * answers to what all others do to it against a scaled identity R,
   *
   *     error = |P - P*|_R / scale,       |x|_R^2 = sum R x^2.
   *
   * Where points have laws, R is the majorant of the problem and the scale
   * |P|_R and a floor (LawEvaluation). Where W is assembled and nothing but
   * contact acts, R = 1, P* = P_K(P - u^) and the scale is the largest of |q|,
   * |P| and |u| (ContactProblem): the measure of Siconos, whose numbers can be
   * compared then.
   */
  inline double relative_natural_map(const double defect, const double scale)
  {
    return defect == 0. ? 0. : defect / scale;
  }
} // namespace nsfd
