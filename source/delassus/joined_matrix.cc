#include "joined_matrix.h"

#include "linear_algebra/sparse_rows.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// unknowns beyond which matrices of bodies are worth being spared
    constexpr long long smallest_by_bodies = 1000;
  } // namespace

  template <int dim>
  JoinedMatrix<dim>::JoinedMatrix(const DelassusOperator<dim> &delassus,
                                  const long long first_dof)
      : delassus_(delassus), bodies_(delassus.bodies()),
        points_(delassus.points()), first_dof_(first_dof)
  {
  }

  template <int dim>
  auto JoinedMatrix<dim>::block_of(const long long number) const -> Block
  {
    const long long block = number / size_,
                    mine = block - space_->first / size_;
    if (mine >= 0 && mine < n_own_)
      return Block(mine);
    return n_own_ +
           Block(std::lower_bound(ghosts_.begin(), ghosts_.end(), block) -
                 ghosts_.begin());
  }

  /** With what points see, and the unknowns of other ranks among it. */
  template <int dim>
  void JoinedMatrix<dim>::number_blocks(const CoarseSpace &space,
                                        const std::vector<char> &shares_nodes)
  {
    std::vector<char> wanted(points_.n_points);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      wanted[i] = !shares_nodes[points_.face_of[i]];
    traces_ = PointTraces(delassus_, first_dof_, wanted);
    const auto end = first_dof_ + static_cast<long long>(bodies_.n_dofs());
    remote_.numbers.clear();
    for (const unsigned int side : {0u, 1u})
      for (const PointTrace &trace : traces_.of_side(side))
        if (trace.first >= 0 &&
            (trace.first < first_dof_ || trace.first >= end))
          for (unsigned int j = 0; j < trace.n_dofs; ++j)
            remote_.numbers.push_back(trace.first + j);
    std::sort(remote_.numbers.begin(), remote_.numbers.end());
    remote_.numbers.erase(
        std::unique(remote_.numbers.begin(), remote_.numbers.end()),
        remote_.numbers.end());
    remote_.values = GhostValues(delassus_.communicator(), first_dof_,
                                 bodies_.n_dofs(), remote_.numbers);
    space_ = &space;
    size_ = space.per_node;
    n_own_ = int(space.n_own / size_);
    std::vector<double> own(space.number.begin(), space.number.end()),
        remote(remote_.numbers.size()); // below 2^53
    remote_.values.fetch(own.data(), remote.data());
    ghosts_.clear();
    const auto note = [&](const long long number) {
      const long long mine = (number - space.first) / size_;
      if (number < space.first || mine >= n_own_)
        ghosts_.push_back(number / size_);
    };
    for (const long long number : space.number)
      note(number);
    for (const double number : remote)
      note(static_cast<long long>(number));
    std::sort(ghosts_.begin(), ghosts_.end());
    ghosts_.erase(std::unique(ghosts_.begin(), ghosts_.end()), ghosts_.end());
    std::vector<long long> ghosts;
    for (const long long block : ghosts_)
      for (unsigned int c = 0; c < size_; ++c)
        ghosts.push_back(block * size_ + c);
    shared_.exchange = GhostValues(delassus_.communicator(), space.first,
                                   std::size_t(space.n_own), ghosts);
    shared_.values.resize(std::size_t(space.n_own) + ghosts.size());
    block_.own.clear();
    block_.remote.clear();
    for (const long long number : space.number)
      block_.own.push_back(block_of(number));
    for (const double number : remote)
      block_.remote.push_back(block_of(static_cast<long long>(number)));
  }

  /** Of the body at a side of a point, in the order of its unknowns. */
  template <int dim>
  auto JoinedMatrix<dim>::blocks_of_side(const std::size_t point,
                                         const unsigned int side) const
      -> std::vector<Block>
  {
    std::vector<Block> result;
    const PointTrace &trace = traces_(side, point);
    if (trace.first < 0)
      return result;
    const long long mine = trace.first - first_dof_;
    const bool own =
        mine >= 0 && mine < static_cast<long long>(bodies_.n_dofs());
    const std::size_t first =
        own ? std::size_t(mine)
            : std::size_t(std::lower_bound(remote_.numbers.begin(),
                                           remote_.numbers.end(), trace.first) -
                          remote_.numbers.begin());
    for (unsigned int j = 0; j < trace.n_dofs; j += size_)
      result.push_back((own ? block_.own : block_.remote)[first + j]);
    return result;
  }

  /** Of the points whose sides can part; common nodes cancel each other. */
  template <int dim>
  void JoinedMatrix<dim>::set_entries(const std::vector<char> &shares_nodes)
  {
    sights_.entries.clear();
    sights_.points.clear();
    sights_.first.assign(1, 0);
    for (std::size_t i = 0; i < points_.n_points; ++i) {
      const std::size_t first = sights_.entries.size();
      double largest = 0.;
      for (unsigned int s = 0; s < 2 && !shares_nodes[points_.face_of[i]];
           ++s) {
        const PointTrace &trace = traces_(s, i);
        const bool own =
            trace.first >= first_dof_ &&
            trace.first < first_dof_ + static_cast<long long>(bodies_.n_dofs());
        const auto blocks = blocks_of_side(i, s);
        for (std::size_t b = 0; b < blocks.size(); ++b) {
          Entry entry{blocks[b], {}, {}};
          bool zero = true;
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int c = 0; c < size_; ++c) {
              const double a = trace.jump[k * trace.n_dofs + b * size_ + c];
              zero = zero && a == 0.;
              largest = std::max(largest, std::abs(a));
              entry.all[k * size_ + c] = a;
              entry.own[k * size_ + c] = own ? a : 0.;
            }
          if (zero)
            continue;
          const auto known = std::find_if(
              sights_.entries.begin() + long(first), sights_.entries.end(),
              [&](const Entry &e) { return e.block == blocks[b]; });
          if (known == sights_.entries.end()) {
            sights_.entries.push_back(entry);
            continue;
          }
          for (unsigned int k = 0; k < dim * size_; ++k) {
            known->all[k] += entry.all[k];
            known->own[k] += entry.own[k];
          }
        }
      }
      const auto vanishes = [&](const Entry &entry) {
        return std::all_of(
            entry.all.begin(), entry.all.end(),
            [&](const double a) { return std::abs(a) <= 1e-12 * largest; });
      };
      sights_.entries.erase(
          std::remove_if(sights_.entries.begin() + long(first),
                         sights_.entries.end(), vanishes),
          sights_.entries.end());
      if (sights_.entries.size() > first)
        sights_.points.push_back(unsigned(i));
      sights_.first.push_back(sights_.entries.size());
    }
  }

  template <int dim>
  void JoinedMatrix<dim>::set_pattern(const std::vector<char> &shares_nodes)
  {
    const std::size_t n_rows = std::size_t(n_own_) + ghosts_.size();
    std::vector<std::pair<Block, Block>> pairs;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t i = bodies_.first_dof[b]; i < bodies_.first_dof[b + 1];
           i += size_)
        for (std::size_t j = bodies_.first_dof[b]; j < bodies_.first_dof[b + 1];
             j += size_)
          pairs.emplace_back(block_.own[i], block_.own[j]);
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const auto &face = points_.faces[f];
      if (shares_nodes[f])
        continue;
      for (std::size_t i = face.first; i < face.first + face.count; ++i)
        for (std::size_t r = sights_.first[i]; r < sights_.first[i + 1]; ++r)
          for (std::size_t c = sights_.first[i]; c < sights_.first[i + 1]; ++c)
            pairs.emplace_back(sights_.entries[r].block,
                               sights_.entries[c].block);
    }
    // sorted by row, then within rows, which are short
    std::vector<std::size_t> first(n_rows + 1, 0);
    for (const auto &pair : pairs)
      ++first[std::size_t(pair.first) + 1];
    for (std::size_t r = 0; r < n_rows; ++r)
      first[r + 1] += first[r];
    std::vector<Block> columns(pairs.size());
    auto next = first;
    for (const auto &[row, column] : pairs)
      columns[next[std::size_t(row)]++] = column;
    pattern_.column.clear();
    pattern_.first.assign(1, 0);
    for (std::size_t r = 0; r < n_rows; ++r) {
      const auto begin = columns.begin() + long(first[r]),
                 end = columns.begin() + long(first[r + 1]);
      std::sort(begin, end);
      pattern_.column.insert(pattern_.column.end(), begin,
                             std::unique(begin, end));
      pattern_.first.push_back(pattern_.column.size());
    }
    if (delassus_.communicator().size() > 1) {
      const auto number = [&](const Block block) {
        return block < n_own_
                   ? space_->first + static_cast<long long>(block) * size_
                   : ghosts_[std::size_t(block - n_own_)] * size_;
      };
      std::vector<SparseEntry> all; // in the order of the values
      for (std::size_t r = 0; r < n_rows; ++r)
        for (unsigned int k = 0; k < size_; ++k)
          for (std::size_t c = pattern_.first[r]; c < pattern_.first[r + 1];
               ++c)
            for (unsigned int l = 0; l < size_; ++l)
              all.push_back(
                  {number(Block(r)) + k, number(pattern_.column[c]) + l, 0.});
      joint_.rows = RowSums(delassus_.communicator(), *space_, all);
      return;
    }
    matrix_ = SparseRows();
    matrix_.start.assign(1, 0);
    for (std::size_t r = 0; r < n_rows; ++r)
      for (unsigned int k = 0; k < size_; ++k) {
        for (std::size_t c = pattern_.first[r]; c < pattern_.first[r + 1]; ++c)
          for (unsigned int l = 0; l < size_; ++l)
            matrix_.column.push_back(pattern_.column[c] * int(size_) + int(l));
        matrix_.start.push_back(int(matrix_.column.size()));
      }
  }

  template <int dim>
  void JoinedMatrix<dim>::set_space(const CoarseSpace &space,
                                    const std::vector<char> &shares_nodes)
  {
    shares_nodes_ = shares_nodes;
    number_blocks(space, shares_nodes);
    set_entries(shares_nodes);
    operators_ = {};
    pattern_ = {};
    by_bodies_.set(bodies_, block_.own, size_,
                   space.n_global > smallest_by_bodies);
    if (by_bodies_.is_used())
      return;
    set_pattern(shares_nodes);
    set_operators();
  }

  /** Entries in a row of scalars. */
  template <int dim>
  std::size_t JoinedMatrix<dim>::width(const Block row) const
  {
    return (pattern_.first[std::size_t(row) + 1] -
            pattern_.first[std::size_t(row)]) *
           size_;
  }

  /** Of the first entry of a block; its rows are width() apart. */
  template <int dim>
  std::size_t JoinedMatrix<dim>::place(const Block row,
                                       const Block column) const
  {
    const std::size_t first = pattern_.first[std::size_t(row)],
                      end = pattern_.first[std::size_t(row) + 1];
    const auto found =
        std::lower_bound(pattern_.column.begin() + long(first),
                         pattern_.column.begin() + long(end), column);
    return first * size_ * size_ +
           std::size_t(found - pattern_.column.begin() - long(first)) * size_;
  }

  /** Add the block that @p select has for a class, or null, of all bodies. */
  template <int dim>
  template <typename Select>
  void JoinedMatrix<dim>::add_bodies(const Select &select,
                                     std::vector<double> &values) const
  {
    for (std::size_t index = 0; index < bodies_.classes.size(); ++index) {
      const BodyClass &body = bodies_.classes[index];
      const nsfd::Block &from = select(index);
      if (from.rows == 0)
        continue;
      for (const unsigned int b : body.bodies)
        for (unsigned int i = 0; i < body.n_dofs; i += size_) {
          const Block row = block_.own[bodies_.first_dof[b] + i];
          for (unsigned int j = 0; j < body.n_dofs; j += size_) {
            const std::size_t first =
                place(row, block_.own[bodies_.first_dof[b] + j]);
            for (unsigned int k = 0; k < size_; ++k)
              for (unsigned int l = 0; l < size_; ++l)
                values[first + k * width(row) + l] += from(i + k, j + l);
          }
        }
    }
  }

  template <int dim>
  void JoinedMatrix<dim>::set_operators()
  {
    const std::size_t n_entries = pattern_.column.size() * size_ * size_;
    const auto &classes = bodies_.classes;
    // on all ranks: products are collective
    const bool damped = delassus_.communicator().any(
        std::any_of(classes.begin(), classes.end(),
                    [](const auto &body) { return body.damping.rows; }));
    operators_.step.clear();
    operators_.mass.assign(n_entries, 0.);
    operators_.stiffness.assign(n_entries, 0.);
    operators_.damping.assign(damped ? n_entries : 0, 0.);
    const auto add = [&](const auto block, std::vector<double> &to) {
      const auto select = [&](const std::size_t k) -> const nsfd::Block & {
        return classes[k].*block;
      };
      add_bodies(select, to);
    };
    add(&BodyClass::mass, operators_.mass);
    add(&BodyClass::stiffness, operators_.stiffness);
    if (damped)
      add(&BodyClass::damping, operators_.damping);
  }

  template <int dim>
  void JoinedMatrix<dim>::add_springs(const double *springs,
                                      std::vector<double> &values) const
  {
    sights_.for_springs(
        springs, size_,
        [&](const Entry &row, const Entry &column, const double *product) {
          double *out = &values[place(row.block, column.block)];
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int k = 0; k < size_; ++k)
              for (unsigned int l = 0; l < size_; ++l)
                out[k * width(row.block) + l] +=
                    row.own[d * size_ + k] * product[d * size_ + l];
        });
  }

  template <int dim>
  long long JoinedMatrix<dim>::node_of_point(const std::size_t point) const
  {
    // one block, or the consecutive unknowns of one node
    const std::size_t n = dim / size_, first = sights_.first[point];
    if (sights_.first[point + 1] != first + n)
      return -1;
    const auto number = [&](const std::size_t k) {
      const Block block = sights_.entries[k].block;
      return block < n_own_ ? space_->first / size_ + block
                            : ghosts_[std::size_t(block - n_own_)];
    };
    for (std::size_t k = 1; k < n; ++k)
      if (number(first + k) != number(first) + static_cast<long long>(k))
        return -1;
    return number(first);
  }

  template <int dim>
  void JoinedMatrix<dim>::set_step(const StepShares &shares)
  {
    if (!(operators_.step.empty() && by_bodies_.step(0).rows == 0) &&
        shares_.stiffness == shares.stiffness &&
        shares_.damping == shares.damping)
      return;
    shares_ = shares;
    if (by_bodies_.is_used())
      return by_bodies_.set_step(shares);
    operators_.step.resize(operators_.mass.size());
    for (std::size_t k = 0; k < operators_.step.size(); ++k)
      operators_.step[k] =
          operators_.mass[k] + shares.stiffness * operators_.stiffness[k];
    for (std::size_t k = 0; k < operators_.damping.size(); ++k)
      operators_.step[k] += shares.damping * operators_.damping[k];
  }

  template <int dim>
  const SparseRows &JoinedMatrix<dim>::assemble(const double *springs)
  {
    if (pattern_.first.empty())
      set_pattern(shares_nodes_);
    const bool alone = delassus_.communicator().size() == 1;
    auto &values = alone ? matrix_.value : joint_.values;
    if (by_bodies_.is_used()) {
      values.assign(pattern_.column.size() * size_ * size_, 0.);
      const auto block = [&](const std::size_t k) -> const nsfd::Block & {
        return by_bodies_.step(k);
      };
      add_bodies(block, values);
    } else
      values = operators_.step;
    if (springs)
      add_springs(springs, values);
    return alone ? matrix_ : joint_.rows.sum(values);
  }

  template class JoinedMatrix<2>;
  template class JoinedMatrix<3>;
} // namespace nsfd
