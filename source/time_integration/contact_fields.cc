#include "contact_fields.h"

#include "nsfd/scene/scene_input.h"
#include "state/point_fields.h"

#include <type_traits>

namespace nsfd
{
  template <int dim>
  void insert_contacts(const SceneInput &input,
                       const ContactPoints<dim> &contacts, State &state)
  {
    for_point_fields([&](const PointField &field, const auto member,
                         const auto &, const auto added) {
      using Value = typename std::decay_t<decltype(state.*member)>::value_type;
      if (has_field(input, field))
        insert_contacts(contacts, state.*member, field.width(dim),
                        Value(added));
    });
  }

  template <int dim>
  void erase_contacts(const SceneInput &input,
                      const ContactPoints<dim> &contacts, State &state)
  {
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          if (has_field(input, field))
            erase_contacts(contacts, state.*member, field.width(dim));
        });
  }

#define INSTANTIATE(dim)                                                       \
  template void insert_contacts<dim>(const SceneInput &,                       \
                                     const ContactPoints<dim> &, State &);     \
  template void erase_contacts<dim>(const SceneInput &,                        \
                                    const ContactPoints<dim> &, State &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
