#include "body_products.h"

#include "body_loops.h"

#include <algorithm>

namespace nsfd
{
  void BodyProducts::set(const Bodies &bodies, const std::vector<int> &nodes,
                         const unsigned int size, const bool pays)
  {
    constexpr std::size_t cache = 1 << 19; // bytes, of one kind of block
    std::size_t bytes = 0;
    for (const BodyClass &body : bodies.classes)
      bytes += std::size_t(padded(body.n_dofs)) * body.n_dofs * sizeof(double);
    bodies_ = &bodies;
    nodes_ = pays && bytes <= cache ? &nodes : nullptr;
    size_ = size;
    step_.clear();
  }

  void BodyProducts::set_step(const StepShares &shares)
  {
    step_.clear();
    for (const BodyClass &body : bodies_->classes) {
      step_.emplace_back(body.n_dofs, body.n_dofs);
      for (unsigned int j = 0; j < body.n_dofs; ++j)
        for (unsigned int i = 0; i < body.n_dofs; ++i)
          step_.back()(i, j) = step_entry(body, shares, i, j);
    }
  }

  const Block &BodyProducts::step(const std::size_t index) const
  {
    static const Block none;
    return index < step_.size() ? step_[index] : none;
  }

  template <unsigned int size, typename Select>
  void BodyProducts::multiply_nodes(const Select &select,
                                    const std::vector<double> &x,
                                    std::vector<double> &y) const
  {
    std::fill(y.begin(), y.end(), 0.);
    // pairs of (place in a body, first value of its node)
    const auto for_nodes = [&](const unsigned int b, const auto &work) {
      const std::size_t first = bodies_->first_dof[b],
                        n = bodies_->first_dof[b + 1] - first;
      for (std::size_t j = 0; j < n; j += size)
        work(j, std::size_t((*nodes_)[first + j]) * size);
    };
    for_all_bodies(
        *bodies_, select,
        [&](const unsigned int b, double *in, const unsigned int stride) {
          for_nodes(b, [&](const std::size_t j, const std::size_t node) {
            for (unsigned int c = 0; c < size; ++c)
              in[(j + c) * stride] = x[node + c];
          });
        },
        [&](const unsigned int b, const double *out,
            const unsigned int stride) {
          for_nodes(b, [&](const std::size_t j, const std::size_t node) {
            for (unsigned int c = 0; c < size; ++c)
              y[node + c] += out[(j + c) * stride];
          });
        });
  }

  template <typename Select>
  void BodyProducts::multiply(const Select &select,
                              const std::vector<double> &x,
                              std::vector<double> &y) const
  {
    switch (size_) {
    case 2:
      return multiply_nodes<2>(select, x, y);
    case 3:
      return multiply_nodes<3>(select, x, y);
    default:
      return multiply_nodes<1>(select, x, y);
    }
  }

  void BodyProducts::apply(Block BodyClass::*const block,
                           const std::vector<double> &x,
                           std::vector<double> &y) const
  {
    multiply(
        [&](const std::size_t k) -> const Block & {
          return bodies_->classes[k].*block;
        },
        x, y);
  }

  void BodyProducts::apply_step(const std::vector<double> &x,
                                std::vector<double> &y) const
  {
    multiply([&](const std::size_t k) -> const Block & { return step_[k]; }, x,
             y);
  }
} // namespace nsfd
