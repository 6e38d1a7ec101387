#pragma once

#include "time_integrator.h"

#include "contact_detection/missed_contacts.h"
#include "mesh/body_table.h"

namespace nsfd
{
  struct SceneInput;

  /** Of a step of length @p h from @p time that passes over a contact: the next
      one shall end where this begins. */
  template <int dim>
  StepRejected passing_bodies(const SceneInput &input, const BodyTable &table,
                              const MissedContact<dim> &missed, double time,
                              double h);
} // namespace nsfd
